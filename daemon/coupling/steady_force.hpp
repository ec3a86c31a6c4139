#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <utility>

#include "daemon/coupling/arm_coupling.hpp"

namespace thimble::coupling {

// A coupling that can be made to wish one steady force, straight up or down, instead of what its
// world says: for a scale under the tip. The wish goes the way of every wish, through the limiter.
// Afterwards the ghost restarts at the hand: no jump. Whoever holds it says so again and again: a
// control thread that hangs lets go, as a world does whose constraints grow old.
//
// Thread: reset() and step() as ArmCoupling; hold(), keep() and release() from one control thread.
// RT: all. Ownership: of the coupling below. Errors: that one's; a wish that is not finite latches
// a fault behind it.
class SteadyForce final : public ArmCoupling {
 public:
  explicit SteadyForce(std::unique_ptr<ArmCoupling> below) : below_(std::move(below)) {}

  // N, along y of the base frame; until `until`, of the servo's clock, unless it is kept.
  void hold(double up_newton, MonotonicTime until) noexcept {
    up_newton_.store(up_newton, std::memory_order_relaxed);
    keep(until);
    is_held_.store(true, std::memory_order_release);
  }
  void keep(MonotonicTime until) noexcept {
    until_ns_.store(until.since_epoch.count(), std::memory_order_relaxed);
  }
  void release() noexcept { is_held_.store(false, std::memory_order_release); }
  [[nodiscard]] bool is_held() const noexcept { return is_held_.load(std::memory_order_relaxed); }

  bool set_impedance(Damping b) noexcept override { return below_->set_impedance(b); }

 private:
  THIMBLE_RT void restart(MonotonicTime now, Position3 tip) noexcept override {
    below_->reset(now, tip);
  }
  THIMBLE_RT ArmOutput advance(const ArmInput& input) noexcept override {
    const bool is_kept = input.now.since_epoch.count() < until_ns_.load(std::memory_order_relaxed);
    const bool is_held = is_held_.load(std::memory_order_acquire) && is_kept;
    if (std::exchange(was_held_, is_held) && !is_held) below_->reset(input.now, input.tip);
    ArmOutput out = below_->step(input);
    if (is_held) out.force = {0, up_newton_.load(std::memory_order_relaxed), 0};
    return out;
  }

  std::unique_ptr<ArmCoupling> below_;
  std::atomic<bool> is_held_{false};
  std::atomic<double> up_newton_{0};
  std::atomic<std::int64_t> until_ns_{0};
  static_assert(std::atomic<double>::is_always_lock_free);
  bool was_held_{false};  // servo
};

}  // namespace thimble::coupling
