#include "sim/model/hand/hand.hpp"

#include <algorithm>
#include <cstddef>

#include "hal/base/check.hpp"

namespace thimble::sim {
namespace {

// Ours: a person who sets an arm to a mark steadies it with both hands.
constexpr double kFirmStiffness = 2000;  // N/m
constexpr double kFirmDamping = 35;      // N s/m

constexpr double kHoldSpeed = 0.3;      // m/s; the stroke is then played faster or slower
constexpr double kShortestHold = 1e-3;  // s

}  // namespace

Hand::Hand(const HandSettings& settings) : settings_(settings), path_(settings) {
  THIMBLE_CHECK(check(settings).has_value());
}

void Hand::hold_at(Position3 point, Duration duration) noexcept {
  mode_ = Mode::Hold;
  target_ = point;
  target_within_ = duration;
  begin_stroke();
}

void Hand::start_motion() noexcept {
  mode_ = Mode::ToOrigin;
  path_ = HandPath(settings_);
  begin_stroke();
}

void Hand::begin_stroke() noexcept {
  stroke_elapsed_ = {};
  stroke_scale_ = 1;
  if (mode_ == Mode::ToOrigin) {
    stroke_ = Stroke(reference_.position, Position3{}, settings_.speed_m_per_s);
  }
  if (mode_ == Mode::Hold) {
    stroke_ = Stroke(reference_.position, target_, kHoldSpeed);
    stroke_scale_ = stroke_.duration_s() / std::max(kShortestHold, seconds(target_within_));
  }
}

void Hand::take_hold(Position3 tip, Velocity3 velocity) noexcept {
  has_hold_ = true;
  finger_ = {tip, velocity};
  reference_ = {tip, {}};
  begin_stroke();
}

PathPoint Hand::advance_reference(Duration dt) noexcept {
  if (mode_ == Mode::Rest) return reference_;
  if (mode_ == Mode::Motion) return path_.advance(dt);
  stroke_elapsed_ += dt;
  const double played_s = seconds(stroke_elapsed_) * stroke_scale_;
  if (mode_ == Mode::ToOrigin && played_s >= stroke_.duration_s()) mode_ = Mode::Motion;
  PathPoint point = stroke_.at(played_s);
  point.velocity = stroke_scale_ * point.velocity;
  return point;
}

Force3 Hand::force_on_tip(MonotonicTime /*t*/, Duration dt, Position3 tip,
                          Velocity3 velocity) noexcept {
  if (!has_hold_) take_hold(tip, velocity);
  reference_ = advance_reference(dt);
  const bool is_firm = mode_ == Mode::Hold;
  const Stiffness muscle{is_firm ? kFirmStiffness : settings_.stiffness_newton_per_m};
  const Damping muscle_damping{is_firm ? kFirmDamping : settings_.damping_newton_s_per_m};
  const Stiffness contact{settings_.contact_newton_per_m};
  const Damping contact_damping{settings_.contact_newton_s_per_m};

  force_ = contact * (finger_.position - tip) + contact_damping * (finger_.velocity - velocity);
  const Force3 pull = muscle * (reference_.position - finger_.position) +
                      muscle_damping * (reference_.velocity - finger_.velocity);
  const double dt_s = seconds(dt);
  for (std::size_t i = 0; i < 3; ++i) {
    finger_.velocity[i] += dt_s * (pull[i] - force_[i]) / settings_.mass_kg;
    finger_.position[i] += dt_s * finger_.velocity[i];
  }
  return force_;
}

}  // namespace thimble::sim
