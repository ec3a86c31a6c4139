#pragma once

#include "hal/base/time.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::servo {

// Share of the force that is let through: rises linearly when the arm may be driven and falls
// when it may not. DESIGN section 4: 0 → 1 in 500 ms on activation, 1 → 0 within 20 ms on
// release of the deadman and on deactivation. A fault does not ramp, it cuts.
//
// Thread: servo. RT: THIMBLE_RT.
class DriveGain {
 public:
  DriveGain(Duration rise, Duration fall) noexcept : rise_(rise), fall_(fall) {}

  THIMBLE_RT double step(bool may_drive, Duration dt) noexcept {
    gain_ += may_drive ? seconds(dt) / seconds(rise_) : -seconds(dt) / seconds(fall_);
    if (gain_ > 1) gain_ = 1;
    if (gain_ < 0) gain_ = 0;
    return gain_;
  }
  THIMBLE_RT void cut() noexcept { gain_ = 0; }
  [[nodiscard]] double value() const noexcept { return gain_; }

 private:
  Duration rise_;
  Duration fall_;
  double gain_{0};
};

}  // namespace thimble::servo
