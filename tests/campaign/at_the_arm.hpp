#pragma once

#include <chrono>

#include "tests/campaign/invariant.hpp"

// What the judges of an arm on HID know of it.
namespace thimble::campaign {

// A current travels in milliampere.
inline constexpr double kQuantum_a = 0.001;
// From the servo's write to the motors: two frames of the bus and a PWM period.
inline constexpr Duration kReach = std::chrono::milliseconds(4);
// A report is that old at most where the arm hears. One that heard nothing for longer shows a force
// of long ago in the pose of today; so does one whose reports are late.
inline constexpr Duration kFresh = std::chrono::milliseconds(6);
// Ten times what a hand at rest sags.
inline constexpr double kHomeReach_m = 0.002;

// Whether the arm is where its driver reckons it: who lets it find its reference away from home,
// shoved or not, has the servo calculate in a pose that it is not in, and nothing can tell from the
// counts.
class ReferenceWatch {
 public:
  void see(const Observation& now) noexcept {
    const CalibrationState calibration = now.servo.frame.calibration;
    if (calibration == CalibrationState::Ok && calibration_ != CalibrationState::Ok) {
      is_true_ = norm(now.servo.frame.tip - now.truth.tip) < kHomeReach_m;
    }
    calibration_ = calibration;
  }
  [[nodiscard]] bool is_true() const noexcept { return is_true_; }

 private:
  bool is_true_{true};
  CalibrationState calibration_{CalibrationState::Unknown};
};

}  // namespace thimble::campaign
