#include "daemon/servo/velocity_filter.hpp"

#include <cmath>
#include <numbers>

namespace thimble::servo {

void VelocityFilter::reset() noexcept {
  has_previous_ = false;
  velocity_ = {};
}

Velocity3 VelocityFilter::update(MonotonicTime at, Position3 tip) noexcept {
  if (!has_previous_) {
    has_previous_ = true;
    previous_at_ = at;
    previous_tip_ = tip;
    return velocity_;
  }
  const double dt_s = seconds(at - previous_at_);
  if (!(dt_s > 0)) return velocity_;
  const Displacement3 moved = tip - previous_tip_;
  const Velocity3 raw{moved.x / dt_s, moved.y / dt_s, moved.z / dt_s};
  if (dt_s != share_dt_s_) {
    share_dt_s_ = dt_s;
    share_ = 1.0 - std::exp(-2.0 * std::numbers::pi * cutoff_hz_ * dt_s);
  }
  velocity_ += share_ * (raw - velocity_);
  previous_at_ = at;
  previous_tip_ = tip;
  return velocity_;
}

}  // namespace thimble::servo
