#pragma once

#include <cmath>

namespace thimble::coupling::testing {

// A hand with its arm on one axis: a mass with a damper to ground, moved by a force that is held
// for each step. Exact, whatever the step.
class HandMass {
 public:
  HandMass(double mass_kg, double damping_newton_s_per_m, double start_m = 0)
      : x_m(start_m), mass_kg_(mass_kg), damping_(damping_newton_s_per_m) {}

  void move(double newton, double dt_s) {
    const double final_m_per_s = newton / damping_;
    const double decay = std::exp(-damping_ * dt_s / mass_kg_);
    x_m += final_m_per_s * dt_s + (v_m_per_s - final_m_per_s) * (1 - decay) * mass_kg_ / damping_;
    v_m_per_s = final_m_per_s + (v_m_per_s - final_m_per_s) * decay;
  }

  double x_m;
  double v_m_per_s{0};

 private:
  double mass_kg_;
  double damping_;
};

}  // namespace thimble::coupling::testing
