#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>

#include "hal/base/time.hpp"
#include "hal/rt/annotations.hpp"
#include "sim/time/virtual_clock.hpp"

namespace thimble::sim {

// Lateness up to which virtual time catches up with the machine's. Ours: half a servo
// period at 1 kHz, so that ordinary wake-up jitter causes no drift, and a catch-up is never
// as long as the frame of a full-speed USB device.
inline constexpr Duration kBrakeTolerance = std::chrono::microseconds(500);

// Virtual time at the machine's pace: each sleep first waits on the real clock, then runs the
// virtual one. When the host stalls for longer than the tolerance, virtual time waits and goes
// on from where it was: a simulated arm gets late, never faulted.
//
// Thread: sleep_until() from the servo thread; everything else from any.
// RT: as Clock; the one system call is the real clock's sleep.
// Ownership: both clocks must outlive it.
class RealTimeBrake final : public Clock {
 public:
  RealTimeBrake(VirtualClock& virtual_clock, Clock& real_clock,
                Duration tolerance = kBrakeTolerance) noexcept
      : virtual_(&virtual_clock), real_(&real_clock), tolerance_(tolerance) {}

  // Virtual time; stands still between two sleeps.
  THIMBLE_RT [[nodiscard]] MonotonicTime now() const noexcept override { return virtual_->now(); }
  // The two time lines are tied together at the first call. Returns the real lateness.
  THIMBLE_RT_IO Duration sleep_until(MonotonicTime deadline) noexcept override;

  // When a virtual time is due on the real clock, if nothing is late until then. After a sleep.
  [[nodiscard]] MonotonicTime real_time_of(MonotonicTime t) const noexcept {
    return anchor_real_ + (t - anchor_virtual_);
  }
  // How far virtual time has fallen behind the machine's since the first sleep.
  [[nodiscard]] Duration total_delay() const noexcept {
    return Duration(total_delay_ns_.load(std::memory_order_relaxed));
  }
  [[nodiscard]] std::uint64_t reanchors() const noexcept {
    return reanchors_.load(std::memory_order_relaxed);
  }

 private:
  VirtualClock* virtual_;
  Clock* real_;
  Duration tolerance_;
  bool is_anchored_{false};
  MonotonicTime anchor_virtual_{};
  MonotonicTime anchor_real_{};
  std::atomic<std::int64_t> total_delay_ns_{0};
  std::atomic<std::uint64_t> reanchors_{0};
};

}  // namespace thimble::sim
