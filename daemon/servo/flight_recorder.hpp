#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "daemon/servo/servo_frame.hpp"
#include "hal/device/fault.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::servo {

// One stop, as the recorder gives it away.
struct FlightStop {
  Fault cause{};
  std::vector<ServoFrame> frames;  // oldest first, at least one: the last is the tick of the stop
  std::uint64_t without_room{0};   // stops since the last take() that were not recorded
};

// The last frames of the servo, kept in memory until a stop freezes them; then the control thread
// takes them at leisure. Meanwhile the servo records into a second memory of the same size, so that
// a second stop, however soon, has its frames from the first one on. What stops a third time before
// one is taken is counted.
//
// Thread: record(), freeze() from the servo; is_frozen(), take() from one control thread. Frozen
// flags hand the memories over, so neither side ever waits.
// RT: record(), freeze() THIMBLE_RT. Ownership: allocates all frames at construction.
class FlightRecorder {
 public:
  explicit FlightRecorder(std::size_t frames);

  THIMBLE_RT void record(const ServoFrame& frame) noexcept {
    Memory& memory = memories_[writing_];
    if (!memory.is_frozen.load(std::memory_order_acquire)) memory.keep(frame);
  }
  // What was recorded up to now, and `last`, is how it came to `cause`.
  THIMBLE_RT void freeze(const ServoFrame& last, const Fault& cause) noexcept;

  // A stop waits to be taken.
  [[nodiscard]] bool is_frozen() const noexcept {
    return memories_[reading_].is_frozen.load(std::memory_order_acquire);
  }
  // The oldest stop that waits, whose memory is then free again. Empty when none does.
  [[nodiscard]] FlightStop take();
  [[nodiscard]] std::size_t capacity() const noexcept { return memories_[0].frames.size(); }

 private:
  struct Memory {
    std::vector<ServoFrame> frames;
    std::uint64_t count{0};
    Fault cause{};
    std::atomic<bool> is_frozen{false};

    void keep(const ServoFrame& frame) noexcept {
      frames[static_cast<std::size_t>(count % frames.size())] = frame;
      ++count;
    }
  };
  std::array<Memory, 2> memories_;
  std::size_t writing_{0};  // servo
  std::size_t reading_{0};  // control
  std::atomic<std::uint64_t> without_room_{0};
};

}  // namespace thimble::servo
