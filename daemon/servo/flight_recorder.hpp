#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "daemon/servo/servo_frame.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::servo {

// The last frames of the servo, kept in memory until a latched stop freezes them; then the
// control plane takes them at leisure while the servo goes on unrecorded.
//
// Thread: record(), freeze() from the servo; take() from one control thread. The frozen flag
// hands the memory over, so neither side ever waits.
// RT: record(), freeze() THIMBLE_RT. Ownership: allocates all frames at construction.
class FlightRecorder {
 public:
  explicit FlightRecorder(std::size_t frames);

  THIMBLE_RT void record(const ServoFrame& frame) noexcept {
    if (is_frozen_.load(std::memory_order_acquire)) return;
    frames_[static_cast<std::size_t>(count_ % frames_.size())] = frame;
    ++count_;
  }
  THIMBLE_RT void freeze() noexcept { is_frozen_.store(true, std::memory_order_release); }

  [[nodiscard]] bool is_frozen() const noexcept {
    return is_frozen_.load(std::memory_order_acquire);
  }
  // The frozen frames, oldest first, and recording starts anew. Empty when not frozen.
  [[nodiscard]] std::vector<ServoFrame> take();
  [[nodiscard]] std::size_t capacity() const noexcept { return frames_.size(); }

 private:
  std::vector<ServoFrame> frames_;
  std::uint64_t count_{0};
  std::atomic<bool> is_frozen_{false};
};

}  // namespace thimble::servo
