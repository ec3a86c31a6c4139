#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "daemon/devices/arm_guard.hpp"
#include "daemon/servo/servo_controls.hpp"
#include "daemon/session/retry_pace.hpp"
#include "hal/base/result.hpp"
#include "hal/device/haptic_device.hpp"

namespace thimble::session {

// The guard of one arm of a session, where the arm needs one: as long as it is gone the servo is
// told that the arm must not be driven.
//
// Thread: control plane. Ownership: `controls` must outlive it; it must outlive the servo.
class GuardedArm {
 public:
  // `guards`: nullptr where there are none. `name`: of the arm, for messages.
  GuardedArm(std::string name, bus::DeviceAddress address, devices::ArmGuards* guards,
             servo::ServoControls& controls)
      : name_(std::move(name)),
        address_(std::move(address)),
        guards_(guards),
        controls_(controls) {}

  // `device` was just opened; until its guard answers, follow() says, it is not driven. Nothing for
  // a simulated arm, and for one that lets go by itself. Unsupported when it needs a guard and none
  // can be had, or its driver does not say what to write; otherwise as ArmGuard::ask().
  [[nodiscard]] Result<void> begin(const HapticDevice& device);
  // Looks whether the guard watches; if it ended, or has not answered for kPatience, asks another
  // one, less and less often. Errors: this try failed. Never waits: worlds are computed meanwhile.
  [[nodiscard]] Result<void> follow(MonotonicTime now);

  // nullptr: this arm has none.
  [[nodiscard]] rt::Heartbeat* heartbeat() noexcept {
    return guard_ ? &guard_->heartbeat() : nullptr;
  }

  // Ours: systemd takes some 100 ms to start a unit on a busy machine.
  static constexpr Duration kPatience = std::chrono::seconds(5);

 private:
  [[nodiscard]] Result<void> ask();
  [[nodiscard]] bool is_overdue(MonotonicTime now) noexcept;

  std::string name_;
  bus::DeviceAddress address_;
  devices::ArmGuards* guards_;
  servo::ServoControls& controls_;
  ZeroCommand zero_{};
  std::unique_ptr<devices::ArmGuard> guard_;
  RetryPace pace_;
  bool is_asked_{false};                      // and has said nothing, nor was it seen to end
  std::optional<MonotonicTime> asked_since_;  // as far as follow() knows
};

}  // namespace thimble::session
