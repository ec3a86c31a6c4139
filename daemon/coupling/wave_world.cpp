#include "daemon/coupling/wave_world.hpp"

#include <algorithm>
#include <cmath>

namespace thimble::coupling {
namespace {

double impedance_of(const HandSample& sample) noexcept {
  const ToolProperties most{.damping = {kMostImpedance_newton_s_per_m}};
  return std::max(kLeastImpedance_newton_s_per_m,
                  sound_tool(sample.tool, most).damping.newton_s_per_m);
}

bool are_sound_waves(const HandSample& sample) noexcept {
  return is_sound(FarEnd{.waves = sample.waves}) && is_finite(sample.impulse);
}

}  // namespace

Result<void> WaveWorld::open(const HandSample& first) {
  if (!are_sound_waves(first)) {
    return fail(Errc::InvalidArgument, "the hand's waves are not finite");
  }
  if (Result<void> opened = slave_.open(first); !opened) return opened;
  b_newton_s_per_m_ = impedance_of(first);
  from_arm_.restart(first.waves);
  to_arm_.restart();
  wanted_ = first.hand;
  hand_ = first.hand;
  hand_impulse_ = first.impulse;
  impulse_ = first.impulse;
  saved_joule_ = {};
  newest_ = 0;
  last_ = {};
  last_.session = next_session_++;
  return {};
}

ConstraintSet WaveWorld::answer(const HandSample& sample, Duration dt) noexcept {
  if (!slave_.is_open()) return last_;
  const bool can_see = slave_.advance(dt, [this](Position3 at, Velocity3 velocity, double step_s) {
    return follow(at, velocity, step_s);
  });
  if (!is_finite(sample.hand) || !are_sound_waves(sample)) return last_;
  if (sample.sequence <= newest_) return last_;
  newest_ = sample.sequence;
  slave_.hear(sample);
  b_newton_s_per_m_ = impedance_of(sample);
  from_arm_.deliver(sample.waves);
  hand_ = sample.hand;
  hand_impulse_ = sample.impulse;
  if (!can_see) return last_;
  slave_.tell(sample, last_);
  last_.far.waves = to_arm_.sums();
  return last_;
}

Force3 WaveWorld::follow(Position3 at, Velocity3 velocity, double step_s) noexcept {
  const double b = b_newton_s_per_m_;
  const double matched = b;  // B_s
  const double root = std::sqrt(2 / b);
  const double felt_newton_s_per_m = matched * b / (matched + b);  // of x_d as the channel holds it
  const Wave3 arrived = from_arm_.take(step_s);
  Force3 force{};
  Wave3 leaving{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double spring = settings_.stiffness.newton_per_m * (wanted_[axis] - at[axis]);
    const double uncorrected =
        (b * spring + matched * (b * root * arrived[axis] - b * velocity[axis])) / (b + matched);
    const double correction = correction_m_per_s(axis, uncorrected, felt_newton_s_per_m, step_s);
    force[axis] = uncorrected + felt_newton_s_per_m * correction;
    leaving[axis] = arrived[axis] - root * force[axis];
    const double wanted_m_per_s = root * arrived[axis] - force[axis] / b + correction;
    wanted_[axis] += wanted_m_per_s * step_s;
    impulse_[axis] += (force[axis] - impulse_[axis] / kImpulseMemory_s) * step_s;
    const double slip_m_per_s = wanted_m_per_s - velocity[axis];
    saved_joule_[axis] =
        std::min(settings_.return_joule,
                 saved_joule_[axis] + matched * slip_m_per_s * slip_m_per_s * step_s);
  }
  to_arm_.send(leaving, step_s);
  return force;
}

double WaveWorld::correction_m_per_s(std::size_t axis, double pull_newton,
                                     double felt_newton_s_per_m, double step_s) noexcept {
  const double missing_m =
      hand_[axis] + (hand_impulse_[axis] - impulse_[axis]) / b_newton_s_per_m_ - wanted_[axis];
  const double speed = std::clamp(settings_.return_per_s * missing_m, -settings_.return_m_per_s,
                                  settings_.return_m_per_s);
  const double cost_joule = (pull_newton + felt_newton_s_per_m * speed) * speed * step_s;
  if (cost_joule > saved_joule_[axis]) return 0;
  saved_joule_[axis] -= std::max(0.0, cost_joule);
  return speed;
}

}  // namespace thimble::coupling
