#pragma once

#include "hal/base/units.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::coupling {

// What a wall gives back at each depth of the finger in it, when its stiffness or its place changes
// under the finger: the force never jumps up, and no change adds energy (decision 0190).
//
//   force           .           Nothing up to gap, a line from there to the
//     |            / stiffness  knee, and the wall's own stiffness beyond it.
//     |       ...x knee         Of a plain wall, gap and knee are 0.
//     |    ...
//     +---+------------- depth
//        gap
//
// Depths in metres along the wall's normal, from its face; > 0 is inside.
// Thread: one servo thread. RT: all calls THIMBLE_RT. Errors: none; finite in, finite out.
class WallSpring {
 public:
  // The plain wall.
  THIMBLE_RT void reset(Stiffness stiffness) noexcept;
  // Of another stiffness from now on, with a finger at `depth_m`. The force there stays, or falls
  // to that of the plain wall; what was stored stays, or less.
  THIMBLE_RT void become(Stiffness stiffness, double depth_m) noexcept;
  // The face was moved by `by_m` > 0 towards the hand, the felt one is not: the finger that was d
  // inside is d + by_m inside and feels what it felt.
  THIMBLE_RT void sink(double by_m) noexcept;

  [[nodiscard]] THIMBLE_RT double force_newton(double depth_m) const noexcept;
  // Stored between the face and this depth.
  [[nodiscard]] THIMBLE_RT double energy_joule(double depth_m) const noexcept;
  // No force up to this depth.
  [[nodiscard]] double gap_m() const noexcept { return gap_m_; }

 private:
  Stiffness stiffness_{};
  double gap_m_{0};
  double knee_m_{0};  // >= gap
  double knee_newton_{0};
};

}  // namespace thimble::coupling
