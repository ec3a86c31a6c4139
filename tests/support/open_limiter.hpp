#pragma once

#include "daemon/servo/wrench_limiter.hpp"
#include "hal/device/haptic_device.hpp"

namespace thimble::test {

// What a limiter makes of `force` that lets everything below the arm's own limits through at once.
// There is no other way to a wrench. `state`: the newest of the arm.
inline LimitedWrench wrench_for(Force3 force, const HapticDevice& arm, const HapticState& state) {
  servo::LimiterSettings open;
  open.max_force_newton = 8;
  open.max_rise_newton_per_s = 1e9;
  open.peak_current_a = arm.capabilities().peak_current_a;
  open.continuous_current_a = open.peak_current_a;
  return servo::WrenchLimiter(open)
      .limit({force, state.motor_current_per_force, 1.0, std::chrono::milliseconds(1)})
      .wrench;
}

}  // namespace thimble::test
