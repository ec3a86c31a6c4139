#pragma once

#include <optional>

#include "daemon/coupling/messages.hpp"
#include "daemon/coupling/probe_in_world.hpp"
#include "daemon/world/world.hpp"

namespace thimble::coupling {

// A face of the world, as messages say it. World frame. Pure; thread: any. Errors: none.
inline ConstraintPlane plane_of(const world::ContactPlane& plane) noexcept {
  return {.normal = plane.normal,
          .offset_m = plane.offset_m,
          .surface = {.stiffness = plane.stiffness,
                      .damping = plane.damping,
                      .friction = plane.friction,
                      .temperature_kelvin = plane.temperature_kelvin}};
}

// What holds a probe back, likewise. Pure; thread: any. Errors: none.
inline PlaneList planes_of(const world::ProbeMotion& motion) noexcept {
  static_assert(world::kMaxContactPlanes <= kMaxPlanes, "every push_back() below finds room");
  PlaneList planes;
  for (const world::ContactPlane& plane : motion.planes) {
    planes.push_back(plane_of(plane));
  }
  return planes;
}

// Makes `set` the next reply of its session: what the world says of the hand in `sample`. The
// ghost is left to the caller.
// Thread: the world's thread. RT: not; neither allocates nor blocks. Errors: none.
inline void tell(const world::ProbeMotion& motion, const HandSample& sample,
                 ConstraintSet& set) noexcept {
  ++set.sequence;
  set.answers = sample.sequence;
  set.sampled_at = sample.sampled_at;
  set.planes = planes_of(motion);
  set.is_embedded = motion.is_embedded;
  set.pressure = motion.pressure;
  set.has_pressure = motion.has_pressure;
}

// Moves a probe that is open after the hand of `sample`, tells the world its buttons and actions,
// and makes `set` the next reply, ghost included. Nothing, and `set` as it was: the hand is
// nowhere, or the world cannot say; to the arm it then looks silent.
// Thread: the world's thread. RT: not; waits and allocates no more than ProbeInWorld's hear() and
// move(). Errors: none.
inline std::optional<world::ProbeMotion> follow_and_tell(ProbeInWorld& probe,
                                                         const HandSample& sample, Duration dt,
                                                         ConstraintSet& set) noexcept {
  if (!is_finite(sample.hand)) return std::nullopt;
  probe.hear(sample);
  const world::ProbeMotion motion = probe.move(sample.hand, dt);
  if (motion.is_silent) return std::nullopt;
  tell(motion, sample, set);
  set.ghost = motion.ghost;
  set.has_ghost = true;
  set.has_ghost_cell = probe.is_among_cells();
  if (set.has_ghost_cell) set.ghost_cell = motion.cell;
  return motion;
}

}  // namespace thimble::coupling
