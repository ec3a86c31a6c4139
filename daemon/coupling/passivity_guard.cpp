#include "daemon/coupling/passivity_guard.hpp"

#include <algorithm>

#include "daemon/coupling/symmetric_dot.hpp"

namespace thimble::coupling {

void PassivityGuard::restart(MonotonicTime now, Position3 tip) noexcept {
  inside_->reset(now, tip);
  given_joule_ = 0;
}

ArmOutput PassivityGuard::advance(const ArmInput& input) noexcept {
  ArmOutput output = inside_->step(input);
  if (!is_finite(input.tip) || !is_finite(input.tip_velocity) || !is_finite(output.force)) {
    return output;
  }
  given_joule_ = std::max(given_joule_ + energy().work_joule(input.tip), -settings_.credit_joule);
  const double damping = damping_newton_s_per_m(output.force, input);
  if (damping > 0) {
    ++steps_damped_;
    if (damping >= settings_.most.newton_s_per_m) ++steps_at_most_;
    output.force -= Damping{damping} * input.tip_velocity;
  }
  return output;
}

double PassivityGuard::damping_newton_s_per_m(Force3 force, const ArmInput& input) const noexcept {
  const double dt_s = seconds(input.dt);
  const Velocity3 velocity = input.tip_velocity;
  const double excess_joule =
      given_joule_ + symmetric_dot(force, velocity) * dt_s - settings_.bound_joule;
  const double speed2 = symmetric_dot(velocity, velocity);  // m²/s²
  const bool can_tell = speed2 >= settings_.least_m_per_s * settings_.least_m_per_s && speed2 > 0;
  if (!(excess_joule > 0) || !can_tell || !(dt_s > 0)) return 0;
  return std::min(settings_.most.newton_s_per_m, excess_joule / (speed2 * dt_s));
}

}  // namespace thimble::coupling
