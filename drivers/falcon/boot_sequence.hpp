#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "drivers/falcon/falcon_codec.hpp"
#include "hal/base/time.hpp"
#include "hal/bus/usb_device.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::falcon {

enum class BootStage : std::uint8_t {
  Detecting,  // does a firmware run already?
  Asking,     // is the boot-loader there?
  Marking,    // an image is announced to it
  Uploading,
  Starting,  // does what was uploaded run?
  Running,
  Resting,  // it did not work: again after a pause
};

// Why the last attempt failed.
enum class BootTrouble : std::uint8_t {
  None,
  NoImage,         // no firmware runs, and no image was given
  NoLoader,        // the boot-loader answered none of the questions
  EchoMissing,     // the loader stopped echoing
  EchoWrong,       // it echoed another byte than was sent
  NotStarted,      // everything was echoed, but then nothing runs
  RequestRefused,  // the USB bridge refused a request
};

// What the sequence wants sent now: at most one of the two.
struct BootOrder {
  enum class Kind : std::uint8_t { Nothing, Request, Packet };
  Kind kind{Kind::Nothing};
  bus::UsbControlRequest request{};
  std::array<std::uint8_t, wire::kUploadChunkBytes> bytes{};
  std::size_t size{0};
  [[nodiscard]] std::span<const std::uint8_t> packet() const noexcept {
    return {bytes.data(), size};
  }
};

// The way from an arm that was just plugged in to one whose firmware runs: looks whether it runs
// already, else asks the boot-loader, uploads the image and compares the echo of every byte, and
// sees that it runs. Repeats the whole as the facts say, then rests and begins again: it ends when
// the arm runs. Nothing here moves a motor: the only commands it sends in run mode are zero. The
// first of them leaves before anything else, and more while a request is not answered: an arm that
// ran for somebody else, or on a handle that died, may hold a force (decision 0286).
//
// A state machine over bytes and time, nothing else. Time is that of the packets that arrive, of
// which the bridge sends one at least every latency period, and of what its owner says besides:
// on_packet() of nothing.
//
// Thread: one. RT: all THIMBLE_RT. Ownership: `image` must outlive it. Errors: none; what fails is
// tried again.
class BootSequence {
 public:
  // `image` empty: there is none, so only a firmware that runs already will do.
  explicit BootSequence(std::span<const std::uint8_t> image) noexcept : image_(image) {}

  // From the beginning; whoever asks knows of no trouble yet.
  THIMBLE_RT void restart() noexcept;
  // Of an arm that ran and has fallen silent, maybe with force on its motors: its bridge is set, so
  // a zero goes out at once, and again and again for kSearch before anything else is tried.
  THIMBLE_RT void find_again() noexcept;
  // What a packet of the bridge carried, maybe nothing, and when it came.
  THIMBLE_RT void on_packet(std::span<const std::uint8_t> serial, MonotonicTime at) noexcept;
  // The end of the request that next() ordered.
  THIMBLE_RT void on_request_end(bus::UsbOutcome outcome) noexcept;
  // Each order comes once; the owner carries it out.
  THIMBLE_RT [[nodiscard]] BootOrder next() noexcept;

  [[nodiscard]] bool is_running() const noexcept { return stage_ == BootStage::Running; }
  // A request has had no end for kRequestPatience, and may never have one, since the bus knows no
  // time-outs: only another handle helps.
  [[nodiscard]] bool is_stuck() const noexcept {
    return is_request_open_ && request_deadline_ && now_ >= *request_deadline_;
  }
  [[nodiscard]] BootStage stage() const noexcept { return stage_; }
  [[nodiscard]] BootTrouble trouble() const noexcept { return trouble_; }

  // How long it waits for an answer: ours. The slowest, a chunk, is 4.3 ms on the line each way
  // and up to a latency period of 16 ms in the bridge.
  static constexpr Duration kPatience = std::chrono::milliseconds(50);
  static constexpr Duration kEchoPatience = std::chrono::milliseconds(250);
  // Ours; a bridge answers a request in a frame or two.
  static constexpr Duration kRequestPatience = std::chrono::milliseconds(500);
  // Ours: what did not work is tried again after that.
  static constexpr Duration kRest = std::chrono::seconds(5);
  // Ours: a cable that is bad for so long is found again by the first zero that passes it.
  static constexpr Duration kSearch = std::chrono::seconds(5);

 private:
  [[nodiscard]] bool is_being_set() const noexcept;
  void enter(BootStage stage) noexcept;
  void on_byte(std::uint8_t byte) noexcept;
  void on_boot_answer(std::uint8_t byte) noexcept;
  void on_echo(std::uint8_t byte) noexcept;
  void on_run_byte(std::uint8_t byte) noexcept;
  void on_silence() noexcept;
  void fail_upload(BootTrouble trouble) noexcept;
  void rest(BootTrouble trouble) noexcept;
  [[nodiscard]] BootOrder talk() const noexcept;
  [[nodiscard]] Duration patience() const noexcept;
  [[nodiscard]] int detect_rounds() const noexcept;
  [[nodiscard]] std::size_t chunk_bytes() const noexcept;

  std::span<const std::uint8_t> image_;
  BootStage stage_{BootStage::Detecting};
  BootTrouble trouble_{BootTrouble::None};
  std::size_t requests_done_{0};  // of those that the stage begins with
  bool is_request_open_{false};
  std::optional<MonotonicTime> request_deadline_;  // from the first packet after it
  MonotonicTime knock_at_{};
  bool wants_to_talk_{true};
  bool is_search_{false};  // Detecting: it ran a moment ago
  bool is_first_{true};    // Detecting: nothing else was tried yet, no upload left half-way
  int repetitions_{0};     // of what the stage says, so far without an answer
  int uploads_{0};
  std::size_t sent_bytes_{0};     // of the image, echoed all
  std::size_t echoed_bytes_{0};   // of the chunk under way
  std::size_t matched_bytes_{0};  // of the boot-loader's answer
  RunParser parser_{};
  MonotonicTime now_{};
  MonotonicTime deadline_{};
};

}  // namespace thimble::falcon
