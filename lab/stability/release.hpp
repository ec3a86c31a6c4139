#pragma once

#include <vector>

#include "hal/base/result.hpp"
#include "lab/findings/findings.hpp"
#include "lab/trial/coupling_case.hpp"

// One trial of stability: a hand that leans on a wall, or floats before it, is let go.
namespace thimble::lab {

inline constexpr double kClear_m = 0.02;  // of the wall, for a hand in free space

struct Release {
  CouplingCase of;
  double delay_s{0};
  double mass_kg{0.15};  // of hand and arm: teleop.md 2(a)
  double damping_newton_s_per_m{2};
  double wall_newton_per_m{-1};  // negative: the scheme's own
  double push_newton{0.005};     // how it leans; 0: in free space
  // How deep it stands at first, m; the wall's face is at 0. What is left of the way to where it
  // rests it goes by itself.
  double depth_m{-0.001};
};

struct Released {
  bool is_stable{false};      // it swings less and less
  double generated_joule{0};  // most that the hand was given beyond what it gave, once let go
};

// The hand, a mass with a damper on one axis and nothing else that would hold it, leans on the wall
// with `push_newton`, braked until it rests; then the brake goes, and it is kicked by 0.1 mm/s. So
// it stays in contact, and a wall that pushes to one side only is the linear one of the theory. The
// velocity is the servo's, filtered. 1 kHz. Deterministic. Errors: the scheme refuses the world.
[[nodiscard]] Result<Released> let_go(const Release& how);

// The numbers of how it is let go and judged, that Release has not.
[[nodiscard]] std::vector<Parameter> release_parameters();

}  // namespace thimble::lab
