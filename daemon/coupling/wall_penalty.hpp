#pragma once

#include "daemon/coupling/messages.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::coupling {

// Ceilings of what a peer may ask for: those of the ghost point (GhostPointSettings).
inline constexpr ToolProperties kHardestTool{.stiffness = {3000}, .damping = {20}};

// `asked` within 0 and `ceiling`; a number that is not finite counts as 0.
[[nodiscard]] THIMBLE_RT ToolProperties sound_tool(const ToolProperties& asked,
                                                   const ToolProperties& ceiling) noexcept;

// Whether a plane is one: finite, its normal of unit length, at most 1000 km from the origin
// (kMaxPlaneOffset_m, decision 0056).
[[nodiscard]] THIMBLE_RT bool is_sound(const ConstraintPlane& plane) noexcept;

// The force of walls on a point that is inside them (teleop.md 2(a)), N:
//
//   F = −Σ n·max(0, K·x + B·(n·v)),  x = n·q − d > 0
//
// q, v  of the point, m and m/s, world frame     n, d  of the plane (ConstraintPlane)
// K, B  of the plane where it names them, else of `tool`: N/m, N·s/m
//
// No wall attracts. A friction that a plane names is not felt. Unsound planes do not push.
//
// Thread: any: pure. RT: THIMBLE_RT. Errors: none; finite in, finite out.
[[nodiscard]] THIMBLE_RT Force3 wall_penalty(const PlaneList& planes, const ToolProperties& tool,
                                             Position3 at, Velocity3 velocity) noexcept;

}  // namespace thimble::coupling
