#include "daemon/coupling/two_port_arm.hpp"

#include <cmath>

#include "daemon/coupling/symmetric_dot.hpp"

namespace thimble::coupling {

void TwoPortArm::restart(MonotonicTime now, Position3 tip) noexcept {
  inside_->reset(now, tip);
  account_.reset();
}

ArmOutput TwoPortArm::advance(const ArmInput& input) noexcept {
  ArmOutput output = inside_->step(input);
  if (input.fresh != nullptr) hear(*input.fresh);
  if (is_finite(input.tip)) {
    const double came_out_joule = energy().work_joule(input.tip);
    account_.take_out(came_out_joule);
    account_.put_in(-came_out_joule);
  }
  output.sample.energy_joule = account_.put_in_joule();
  const double damping = withheld_newton_s_per_m(output.force, input);
  if (damping > 0) {
    ++steps_withheld_;
    output.force -= Damping{damping} * input.tip_velocity;
  }
  return output;
}

void TwoPortArm::hear(const ConstraintSet& said) noexcept {
  if (said.session != session_) account_.forget_other_end();
  session_ = said.session;
  account_.hear(said.energy_joule);
}

// 0 of what is not finite.
double TwoPortArm::withheld_newton_s_per_m(Force3 force, const ArmInput& input) const noexcept {
  const double dt_s = seconds(input.dt);
  const Velocity3 v = input.tip_velocity;
  const double power_watt = symmetric_dot(force, v);
  const double excess_watt = power_watt - account_.left_joule() / dt_s;
  const double speed2 = symmetric_dot(v, v);  // m²/s²
  const bool can_tell = speed2 >= least_m_per_s_ * least_m_per_s_ && speed2 > 0;
  if (!(excess_watt > 0) || !can_tell || !(dt_s > 0)) return 0;
  const double damping = excess_watt / speed2;
  return std::isfinite(damping) && is_finite(force) ? damping : 0;
}

}  // namespace thimble::coupling
