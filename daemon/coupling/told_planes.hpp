#pragma once

#include <cstddef>
#include <cstdint>

#include "daemon/coupling/messages.hpp"
#include "hal/rt/annotations.hpp"

// What an arm half makes of the planes that it is told. World frame. Pure; thread: any.
namespace thimble::coupling {

// Normals closer than 14° are the same face of a curved surface; voxel faces differ by 90°. Ours:
// on a ball of 20 mm 14° are 5 mm, the way of a hand at 0.2 m/s between answers that are 25 ms
// apart.
inline constexpr double kSameFaceCosine = 0.97;

// How far a hand is past a plane, m; < 0: on its free side.
[[nodiscard]] THIMBLE_RT inline double depth_m(const ConstraintPlane& plane,
                                               Position3 hand) noexcept {
  return dot(plane.normal, hand) - plane.offset_m;
}

// What a reply says, without planes that are unsound (wall_penalty.hpp), which are counted in
// `rejected`, and of several planes with one normal only the tightest.
// RT: THIMBLE_RT. Errors: none.
[[nodiscard]] THIMBLE_RT PlaneList sound_planes(const PlaneList& planes,
                                                std::uint64_t& rejected) noexcept;

// Of faces already known, which have a `plane` each, the one that `plane` is most likely to be;
// their number, if it is none of those that are not taken.
template <class Faces, class Taken>
[[nodiscard]] THIMBLE_RT std::size_t find_same_face(const Faces& known, const Taken& is_taken,
                                                    const ConstraintPlane& plane) noexcept {
  std::size_t best = known.size();
  double best_cosine = kSameFaceCosine;
  for (std::size_t i = 0; i < known.size(); ++i) {
    const double cosine = dot(known[i].plane.normal, plane.normal);
    if (is_taken[i] || cosine < best_cosine) continue;
    best = i;
    best_cosine = cosine;
  }
  return best;
}

// How deep a finger is left inside a wall that was learned of late: min(hysteresis, cell/4), so
// that fine worlds do not swallow it; `cell_m` 0: the world has none.
[[nodiscard]] THIMBLE_RT double effective_hysteresis_m(double hysteresis_m, double cell_m) noexcept;

}  // namespace thimble::coupling
