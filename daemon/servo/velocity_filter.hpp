#pragma once

#include "hal/base/geometry.hpp"
#include "hal/base/time.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::servo {

// Tip velocity from positions: difference of successive fresh samples over the time between
// them, through a first-order low-pass. The cut-off is a frequency, so the result does not
// depend on the servo's rate.
//
// 80 Hz (ours): at 1 kHz an encoder step of 0.03 mm is 30 mm/s of noise, which the low-pass
// brings to 12 mm/s, for 2 ms of lag.
//
// Thread: servo. RT: THIMBLE_RT.
class VelocityFilter {
 public:
  explicit VelocityFilter(double cutoff_hz = 80.0) noexcept : cutoff_hz_(cutoff_hz) {}

  THIMBLE_RT void reset() noexcept;
  // `at` must not go backwards; a sample at the same time as the previous changes nothing.
  THIMBLE_RT Velocity3 update(MonotonicTime at, Position3 tip) noexcept;
  [[nodiscard]] Velocity3 velocity() const noexcept { return velocity_; }

 private:
  double cutoff_hz_;
  bool has_previous_{false};
  MonotonicTime previous_at_{};
  Position3 previous_tip_{};
  Velocity3 velocity_{};
  // Of the last time step: an arm that reports in step needs no exponential each time.
  double share_dt_s_{0};
  double share_{0};
};

}  // namespace thimble::servo
