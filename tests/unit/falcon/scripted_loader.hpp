#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <vector>

#include "hal/bus/usb_device.hpp"
#include "tests/unit/falcon/run_packet_oracle.hpp"

namespace thimble::falcon::test {

// How an arm behaves whose boot a test watches.
struct LoaderScript {
  bool is_firmware_running{false};
  bool is_there{true};          // answers questions
  bool is_good_image{true};     // what was uploaded runs
  int deaf_questions{0};        // so many are not answered
  bool says_zero_first{false};  // before its answer
  int spoilt_uploads{0};        // of so many the echo is as the next three say
  std::size_t lost_echo{SIZE_MAX};
  std::size_t wrong_echo{SIZE_MAX};
  std::size_t short_packet{SIZE_MAX};  // the packet with this byte is cut before it
  int refused_requests{0};
  bool echoes_in_run_mode{false};  // as a loader that waits for more of an image might
};

// The arm's side of a boot, in bytes and for a BootSequence alone: no timing but one answer per
// call. Written from the facts sheet, section 1.4, with numbers of its own.
class ScriptedLoader {
 public:
  ScriptedLoader(const LoaderScript& script, std::size_t image_bytes)
      : script_(script), image_bytes_(image_bytes) {}

  bus::UsbOutcome on_request(const bus::UsbControlRequest& request) {
    requests.push_back({request.request, request.value});
    if (script_.refused_requests > 0) {
      --script_.refused_requests;
      return bus::UsbOutcome::Stalled;
    }
    if (request.request == 3) divisor_ = request.value;
    if (request.request == 1 && request.value == 0x0101) image.clear();
    if (request.request == 0 && request.value == 1) output_.clear();
    return bus::UsbOutcome::Done;
  }

  void on_packet(std::span<const std::uint8_t> packet) {
    const Bytes bytes(packet.begin(), packet.end());
    if (divisor_ == 0x4138) return on_question(bytes);
    if (divisor_ == 0x0015) return on_upload(bytes);
    if (divisor_ == 0x0002) return on_run(bytes);
  }

  // At most `most` of the bytes that are on their way.
  Bytes take_output(std::size_t most) {
    Bytes bytes;
    for (; !output_.empty() && bytes.size() < most; output_.pop_front()) {
      bytes.push_back(output_.front());
    }
    return bytes;
  }

  std::vector<std::pair<int, int>> requests;  // number and value
  Bytes image;                                // of the last upload
  int questions{0};
  int uploads{0};
  int run_packets{0};

 private:
  void say(const Bytes& bytes) { output_.insert(output_.end(), bytes.begin(), bytes.end()); }

  void on_question(const Bytes& bytes) {
    if (bytes != Bytes{0x0a, 0x43, 0x0d}) return;
    ++questions;
    if (!script_.is_there || questions <= script_.deaf_questions) return;
    if (script_.says_zero_first) say({0x00});
    say({0x0a, 0x44, 0x2c, 0x0d});
    is_marked_ = false;
  }

  void on_upload(const Bytes& bytes) {
    if (!is_marked_) {
      if (bytes != Bytes{0x41}) return;
      is_marked_ = true;
      ++uploads;
      image.clear();
      return say(bytes);
    }
    const bool is_spoilt = uploads <= script_.spoilt_uploads;
    for (const std::uint8_t byte : bytes) {
      const std::size_t at = image.size();
      if (is_spoilt && at == script_.short_packet) return;
      image.push_back(byte);
      if (is_spoilt && at == script_.lost_echo) continue;
      say({static_cast<std::uint8_t>(is_spoilt && at == script_.wrong_echo ? ~byte : byte)});
    }
  }

  void on_run(const Bytes& bytes) {
    ++run_packets;
    const bool is_loaded = image.size() == image_bytes_ && script_.is_good_image;
    if (script_.is_firmware_running || is_loaded) return say(report_bytes({5, -6, 7}, 0));
    if (script_.echoes_in_run_mode) say(bytes);
  }

  LoaderScript script_;
  std::size_t image_bytes_;
  int divisor_{0};
  bool is_marked_{false};
  std::deque<std::uint8_t> output_;
};

}  // namespace thimble::falcon::test
