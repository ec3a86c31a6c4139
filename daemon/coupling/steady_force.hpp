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

  // Ours: the age at which constraints of a world begin to fade (DESIGN section 4).
  static constexpr Duration kUnkept = std::chrono::milliseconds(250);

  // N, along y of the base frame; until release(), or until it was not kept for kUnkept of the
  // servo's clock.
  void hold(double up_newton) noexcept {
    up_newton_.store(up_newton, std::memory_order_relaxed);
    hold_.store(++holds_, std::memory_order_release);
  }
  void release() noexcept { hold_.store(0, std::memory_order_release); }
  void keep() noexcept { kept_.store(++keeps_, std::memory_order_relaxed); }
  [[nodiscard]] bool is_held() const noexcept { return hold_.load(std::memory_order_relaxed) != 0; }

  bool set_impedance(Damping b) noexcept override { return below_->set_impedance(b); }

 private:
  THIMBLE_RT void restart(MonotonicTime now, Position3 tip) noexcept override {
    below_->reset(now, tip);
  }
  THIMBLE_RT ArmOutput advance(const ArmInput& input) noexcept override {
    const std::uint32_t hold = hold_.load(std::memory_order_acquire);
    const bool is_held = hold != 0 && is_kept(hold, input.now);
    if (std::exchange(was_held_, is_held) && !is_held) below_->reset(input.now, input.tip);
    ArmOutput out = below_->step(input);
    if (is_held) out.force = {0, up_newton_.load(std::memory_order_relaxed), 0};
    return out;
  }
  // One that was let go of does not come back, whoever keeps it afterwards.
  THIMBLE_RT bool is_kept(std::uint32_t hold, MonotonicTime now) noexcept {
    const std::uint32_t kept = kept_.load(std::memory_order_relaxed);
    const bool is_new = std::exchange(hold_seen_, hold) != hold;
    if (std::exchange(kept_seen_, kept) != kept || is_new) kept_at_ = now;
    if (now - kept_at_ >= kUnkept) let_go_ = hold;
    return hold != let_go_;
  }

  std::unique_ptr<ArmCoupling> below_;
  std::atomic<std::uint32_t> hold_{0};  // which one it is; 0: none
  std::atomic<std::uint32_t> kept_{0};  // how often it was kept
  std::atomic<double> up_newton_{0};
  static_assert(std::atomic<double>::is_always_lock_free);
  std::uint32_t holds_{0};  // of the control thread
  std::uint32_t keeps_{0};
  bool was_held_{false};  // from here on the servo's
  std::uint32_t hold_seen_{0};
  std::uint32_t kept_seen_{0};
  MonotonicTime kept_at_{};
  std::uint32_t let_go_{0};
};

}  // namespace thimble::coupling
