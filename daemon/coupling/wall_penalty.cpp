#include "daemon/coupling/wall_penalty.hpp"

#include <algorithm>
#include <cmath>

namespace thimble::coupling {
namespace {

// |n|² may be off by this much; beyond it the plane is garbage, not rounding.
constexpr double kUnitTolerance = 1e-6;
// Nothing that a hand touches is as far; beyond it rounding would be felt.
constexpr double kMaxPlaneOffset_m = 1e6;

double within(double asked, double ceiling) noexcept {
  return std::isfinite(asked) ? std::clamp(asked, 0.0, ceiling) : 0.0;
}

double named_or(double named, double otherwise, double ceiling) noexcept {
  return named >= 0 ? std::min(named, ceiling) : otherwise;
}

}  // namespace

bool is_sound(const ConstraintPlane& plane) noexcept {
  if (!is_finite(plane.normal) || !(std::abs(plane.offset_m) <= kMaxPlaneOffset_m)) return false;
  return std::abs(dot(plane.normal, plane.normal) - 1) <= kUnitTolerance;
}

ToolProperties sound_tool(const ToolProperties& asked, const ToolProperties& ceiling) noexcept {
  return {.stiffness = {within(asked.stiffness.newton_per_m, ceiling.stiffness.newton_per_m)},
          .damping = {within(asked.damping.newton_s_per_m, ceiling.damping.newton_s_per_m)}};
}

Force3 wall_penalty(const PlaneList& planes, const ToolProperties& tool, Position3 at,
                    Velocity3 velocity) noexcept {
  Force3 force{};
  for (const ConstraintPlane& plane : planes) {
    const double depth_m = dot(plane.normal, at) - plane.offset_m;
    if (!(depth_m > 0) || !is_sound(plane)) continue;
    const double stiffness =
        named_or(plane.surface.stiffness.newton_per_m, tool.stiffness.newton_per_m,
                 kHardestTool.stiffness.newton_per_m);
    const double damping =
        named_or(plane.surface.damping.newton_s_per_m, tool.damping.newton_s_per_m,
                 kHardestTool.damping.newton_s_per_m);
    const double push_newton = stiffness * depth_m + damping * dot(plane.normal, velocity);
    force -= along<ForceTag>(plane.normal, std::max(0.0, push_newton));
  }
  return force;
}

}  // namespace thimble::coupling
