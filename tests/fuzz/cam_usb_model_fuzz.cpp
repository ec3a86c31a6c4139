#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "drivers/cambus/usb_frame.hpp"
#include "hal/base/check.hpp"
#include "sim/model/cam/cam_usb_model.hpp"

namespace {

namespace cam = thimble::sim::cam;
namespace usb = thimble::cambus::usb;
using thimble::plugin::UsbHandshake;

constexpr std::size_t kPacket = usb::kFullSpeedPacketBytes;
constexpr std::uint32_t kWindow = 0x1000;
constexpr std::uint32_t kEnd = 0x3000;

// A host that sends packets of any bytes, and requests that are sound but for what they ask for; a
// doorbell is rung by none: what boards do with lists is cam_model's.
class Host {
 public:
  explicit Host(std::span<const std::uint8_t> input) : rest_(input) { model_.advance({}); }

  void play() {
    while (!rest_.empty()) {
      const std::uint8_t what = next();
      if (what < 96) {
        raw(what);
      } else if (what < 192) {
        ask(what);
      } else {
        hear();
      }
    }
    drain();
    begin();
  }

 private:
  std::uint8_t next() {
    if (rest_.empty()) return 0;
    const std::uint8_t byte = rest_.front();
    rest_ = rest_.subspan(1);
    return byte;
  }
  void send(std::span<const std::uint8_t> packet) {
    const UsbHandshake said = model_.out_packet(usb::kRequests, packet);
    THIMBLE_CHECK(said != UsbHandshake::Stall);
  }
  void raw(std::size_t size) {
    const auto packet = rest_.first(std::min({size, kPacket, rest_.size()}));
    rest_ = rest_.subspan(packet.size());
    send(packet);
  }
  void ask(std::uint8_t what) {
    const auto kind = static_cast<usb::Kind>(1 + what % 3);
    std::uint32_t offset = next() * 64U + next();
    if (kind == usb::Kind::Write) offset = std::max(offset, kWindow);
    if (kind == usb::Kind::Begin) offset = 0;
    const std::uint16_t words = kind == usb::Kind::Begin ? 0 : next();
    const std::vector<std::uint8_t> payload(kind == usb::Kind::Write ? 4 * words : 0, what);
    if (what % 16 != 0) ++number_;
    const auto bytes = thimble::cambus::usb_request({kind, {}, number_, words, offset}, payload);
    for (std::size_t at = 0; at < bytes.size(); at += kPacket) {
      send(std::span(bytes).subspan(at, std::min(kPacket, bytes.size() - at)));
    }
    if (bytes.size() % kPacket == 0) send({});
  }
  bool hear() {
    std::array<std::uint8_t, kPacket> room{};
    const auto answer = model_.in_packet(usb::kReplies, room);
    if (answer.handshake == UsbHandshake::Nak) return false;
    THIMBLE_CHECK(answer.handshake == UsbHandshake::Ack && answer.size <= kPacket);
    return true;
  }
  void drain() {
    while (hear()) {
    }
    send({});
    while (hear()) {
    }
  }
  // Whatever came before, it answers.
  void begin() {
    send(thimble::cambus::usb_request({usb::Kind::Begin, {}, 7, 0, 0}, {}));
    std::array<std::uint8_t, kPacket> room{};
    const auto answer = model_.in_packet(usb::kReplies, room);
    THIMBLE_CHECK(answer.handshake == UsbHandshake::Ack && answer.size == usb::kHeaderBytes);
    const auto reply = thimble::cambus::parse_usb_reply(std::span(room).first(answer.size));
    THIMBLE_CHECK(reply && reply->head.number == 7 && reply->head.status == usb::Status::Done);
  }

  std::span<const std::uint8_t> rest_;
  cam::CamUsbModel model_{{.shape = {{1, 1, 1}, 4}, .window_bytes = kEnd - kWindow}};
  std::uint16_t number_{0};
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Host(std::span(data, size)).play();
  return 0;
}
