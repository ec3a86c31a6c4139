#pragma once

#include <cmath>

#include "hal/rt/annotations.hpp"

namespace thimble::sim {

// Of one angle. A pose that is turned by a small step follows from the one before by the addition
// theorems, without the library's sine.
//
// Thread: any. RT: all. Errors: none.
struct SineCosine {
  double sine, cosine;

  // Of the angle that is `step` further.
  THIMBLE_RT [[nodiscard]] SineCosine after(const SineCosine& step) const noexcept {
    return {sine * step.cosine + cosine * step.sine, cosine * step.cosine - sine * step.sine};
  }
};

// Ours: up to this step Taylor's terms to the 8th power are exact in double (0.03^9 / 9! < 1e-19).
inline constexpr double kSmallStep_rad = 0.03;

THIMBLE_RT [[nodiscard]] inline SineCosine sine_cosine_of(double step_rad) noexcept {
  if (!(std::abs(step_rad) <= kSmallStep_rad)) return {std::sin(step_rad), std::cos(step_rad)};
  const double squared = step_rad * step_rad;
  return {step_rad * (1 - squared * (1.0 / 6 - squared * (1.0 / 120 - squared / 5040))),
          1 - squared * (1.0 / 2 - squared * (1.0 / 24 - squared * (1.0 / 720 - squared / 40320)))};
}

}  // namespace thimble::sim
