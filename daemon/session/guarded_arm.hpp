#pragma once

#include <memory>
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

  // `device` was just opened. Nothing for a simulated arm, and for one that lets go by itself.
  // Unsupported when it needs a guard and none can be had, or its driver does not say what to
  // write; otherwise as ArmGuard::watch().
  [[nodiscard]] Result<void> begin(const HapticDevice& device);
  // Looks whether the guard still watches; if not, has another one watch, trying less and less
  // often. Errors: this try failed.
  [[nodiscard]] Result<void> follow(MonotonicTime now);

  // nullptr: this arm has none.
  [[nodiscard]] rt::Heartbeat* heartbeat() noexcept {
    return guard_ ? &guard_->heartbeat() : nullptr;
  }

 private:
  [[nodiscard]] Result<void> watch();

  std::string name_;
  bus::DeviceAddress address_;
  devices::ArmGuards* guards_;
  servo::ServoControls& controls_;
  ZeroCommand zero_{};
  std::unique_ptr<devices::ArmGuard> guard_;
  RetryPace pace_;
};

}  // namespace thimble::session
