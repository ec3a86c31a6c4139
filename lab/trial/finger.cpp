#include "lab/trial/finger.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace thimble::lab {
namespace {

constexpr int kSubsteps = 20;               // teleop.md 3: 20 kHz below 1 kHz
constexpr double kStiction_m_per_s = 1e-3;  // ours: where dry friction changes its sign

}  // namespace

Finger::Finger(Position3 start, Duration dt, const FingerSettings& settings)
    : settings_(settings), dt_(dt), tip_(start) {
  (void)filter_.update(now_, tip_);
}

void Finger::move(const FingerGoal& goal, Force3 commanded) {
  Force3 given;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    given[axis] = std::clamp(commanded[axis], -settings_.most_newton, settings_.most_newton);
  }
  for (int i = 0; i < kSubsteps; ++i) step(goal, given, dt_ / kSubsteps);
  now_ = now_ + dt_;
  (void)filter_.update(now_, tip_);
}

void Finger::step(const FingerGoal& goal, Force3 given, Duration dt) noexcept {
  const double dt_s = seconds(dt);
  const Position3 before = tip_;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool is_pushed = goal.is_pushing && axis == 0;
    const double drawn_newton =
        settings_.stiffness_newton_per_m * (goal.at[axis] - tip_[axis]) +
        settings_.damping_newton_s_per_m * (goal.moving[axis] - velocity_[axis]);
    const double pushed_newton =
        goal.push_newton - settings_.damping_newton_s_per_m * velocity_[axis];
    const double wanted_newton = is_pushed ? pushed_newton : drawn_newton;
    const double friction_newton =
        settings_.friction_newton * std::tanh(velocity_[axis] / kStiction_m_per_s);
    velocity_[axis] += dt_s * (wanted_newton + given[axis] - friction_newton) / settings_.mass_kg;
    tip_[axis] += dt_s * velocity_[axis];
    if (std::abs(tip_[axis]) <= settings_.reach_m) continue;
    tip_[axis] = std::copysign(settings_.reach_m, tip_[axis]);
    velocity_[axis] = 0;
  }
  const Displacement3 moved = tip_ - before;
  energy_.add(given, {moved.x / dt_s, moved.y / dt_s, moved.z / dt_s}, dt);
}

}  // namespace thimble::lab
