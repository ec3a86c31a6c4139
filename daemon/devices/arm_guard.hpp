#pragma once

#include <memory>

#include "hal/base/result.hpp"
#include "hal/bus/device_address.hpp"
#include "hal/device/haptic_device.hpp"
#include "hal/device/zero_command.hpp"
#include "hal/rt/heartbeat.hpp"

namespace thimble::devices {

// DESIGN section 4: an arm whose own watchdog is slower than the 20 ms of "servo late", or unknown,
// has a guard. One that cannot push needs none.
inline constexpr Duration kQuickWatchdog = std::chrono::milliseconds(20);
[[nodiscard]] constexpr bool needs_guard(const HapticCapabilities& arm) noexcept {
  const bool is_quick =
      arm.device_watchdog > Duration::zero() && arm.device_watchdog <= kQuickWatchdog;
  return arm.is_actuated && !is_quick;
}

// What lets one arm go when its servo stops: a process of its own in the daemon.
//
// Thread: control thread; heartbeat() is the servo's and the guard's. Not RT.
// Ownership: must outlive the servo that beats on it. When it ends, the arm is let go.
class ArmGuard {
 public:
  virtual ~ArmGuard() = default;
  [[nodiscard]] virtual rt::Heartbeat& heartbeat() noexcept = 0;
  // It shall watch the device at `address`, just opened, and no other: from now on nothing watches
  // until it answers, which is never waited for. The device is not closed before this returns:
  // that would wait for the kernel here (linux::BusEnumerator::share()). Errors: why nobody can be
  // asked: NotFound when that device is not open or there is no guard's program, Permission, Busy,
  // System.
  [[nodiscard]] virtual Result<void> ask(const bus::DeviceAddress& address,
                                         const ZeroCommand& zero) = 0;
  // False: it was asked, and has not answered yet. Errors: System when it ended, or was never
  // asked.
  [[nodiscard]] virtual Result<bool> is_watching() = 0;
};

// Makes guards. Thread: control thread. Ownership: must outlive them. Errors: System.
class ArmGuards {
 public:
  virtual ~ArmGuards() = default;
  [[nodiscard]] virtual Result<std::unique_ptr<ArmGuard>> make() = 0;
};

}  // namespace thimble::devices
