#pragma once

#include <algorithm>

#include "daemon/coupling/messages.hpp"
#include "hal/base/geometry.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::coupling {

// How a plane feels, every number of it named: the plane's own where it has one, within the
// ceilings of the arm's settings, else the arm's.
template <class Settings>
[[nodiscard]] THIMBLE_RT SurfaceProperties surface_of(const ConstraintPlane& plane,
                                                      const Settings& settings) noexcept {
  SurfaceProperties out{settings.stiffness, settings.damping, settings.friction};
  const SurfaceProperties& named = plane.surface;
  if (named.stiffness.newton_per_m >= 0)
    out.stiffness = std::min(named.stiffness, settings.max_stiffness);
  if (named.damping.newton_s_per_m >= 0)
    out.damping = std::min(named.damping, settings.max_damping);
  if (named.friction >= 0) out.friction = std::min(named.friction, settings.max_friction);
  return out;
}

// Friction of a tip that is `stretch` away, along the surface, from the place where it sticks, and
// slides at `sliding` along it: a spring and a damper, together at most `hold_newton`. The place
// slips as soon as the spring is stretched more than that; `stretch` becomes what is left. It
// depends on the way, not on the time, and gives back no more than it took (decision 0129).
//
// Thread: any: pure. RT: THIMBLE_RT. Units: m, m/s, N. Errors: none; finite in, finite out.
[[nodiscard]] THIMBLE_RT Force3 rub(Displacement3& stretch, Velocity3 sliding,
                                    const SurfaceProperties& surface, double hold_newton) noexcept;

}  // namespace thimble::coupling
