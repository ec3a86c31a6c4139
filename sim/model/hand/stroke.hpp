#pragma once

#include "hal/base/geometry.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::sim {

struct PathPoint {
  Position3 position{};
  Velocity3 velocity{};
};

// One straight movement from rest to rest: speed rises, stays and falls, linearly in time.
// Thread: immutable, any. RT: all. Errors: none; ends that coincide give a stroke of no time.
class Stroke {
 public:
  Stroke() = default;
  // At most `speed_m_per_s` > 0, and never faster than can be reached and left on the way.
  THIMBLE_RT Stroke(Position3 from, Position3 to, double speed_m_per_s) noexcept;
  [[nodiscard]] double duration_s() const noexcept { return 2 * ramp_s_ + cruise_s_; }
  THIMBLE_RT [[nodiscard]] PathPoint at(double t_s) const noexcept;
  [[nodiscard]] Position3 end() const noexcept { return to_; }

 private:
  Position3 from_{}, to_{};
  Direction3 along_{};
  double peak_m_per_s_{0};
  double ramp_s_{0};
  double cruise_s_{0};
};

}  // namespace thimble::sim
