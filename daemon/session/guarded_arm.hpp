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
// Thread: control thread. Ownership: `controls` must outlive it; it must outlive the servo.
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
  // one, less and less often until one has watched for kProven. Errors: it ended or did not answer,
  // once each; this try failed. Never waits: worlds are computed meanwhile.
  [[nodiscard]] Result<void> follow(MonotonicTime now);

  // nullptr: this arm has none.
  [[nodiscard]] rt::Heartbeat* heartbeat() noexcept {
    return guard_ ? &guard_->heartbeat() : nullptr;
  }

  // Ours: systemd takes some 100 ms to start a unit on a busy machine.
  static constexpr Duration kPatience = std::chrono::seconds(5);
  // Ours: one that answers and ends, again and again, is no better than one that does not answer.
  static constexpr Duration kProven = std::chrono::seconds(10);

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
  bool is_asked_{false};  // and nobody was told yet that it ended or does not answer
  // As far as follow() knows:
  std::optional<MonotonicTime> asked_since_;
  std::optional<MonotonicTime> watching_since_;
};

}  // namespace thimble::session
