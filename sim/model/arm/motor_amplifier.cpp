#include "sim/model/arm/motor_amplifier.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace thimble::sim {

using phantom::wire::kPwmNeutral;
using phantom::wire::kPwmSpan;

void MotorAmplifier::power_up(MonotonicTime t) noexcept {
  powered_at_ = t;
  disable();
  duty_.fill(kPwmNeutral);
}

double MotorAmplifier::duty_of(double current_a) noexcept {
  if (std::abs(current_a) > full_scale_a_) ++saturations_;
  const double duty = kPwmNeutral + kPwmSpan * current_a / full_scale_a_;
  return std::round(std::clamp(duty, 0.0, 1.0) * pwm_.period_counts) / pwm_.period_counts;
}

MonotonicTime MotorAmplifier::next_period_start(MonotonicTime t) const noexcept {
  const Duration since_first = t - (powered_at_ + phase_);
  if (since_first <= Duration{0}) return powered_at_ + phase_;
  const auto periods = (since_first.count() + pwm_.period.count() - 1) / pwm_.period.count();
  return powered_at_ + phase_ + periods * pwm_.period;
}

void MotorAmplifier::write_current(MonotonicTime t,
                                   const std::array<double, 3>& current_a) noexcept {
  for (std::size_t i = 0; i < 3; ++i) pending_duty_[i] = duty_of(current_a[i]);
  pending_from_ = next_period_start(t);
  has_pending_ = true;
}

void MotorAmplifier::disable() noexcept {
  is_on_ = false;
  // Neutral by the time anybody can enable again: the next write replaces it within a period.
  has_pending_ = false;
  duty_.fill(kPwmNeutral);
}

void MotorAmplifier::run_until(MonotonicTime t) noexcept {
  if (!has_pending_ || pending_from_ > t) return;
  duty_ = pending_duty_;
  has_pending_ = false;
}

std::array<double, 3> MotorAmplifier::current_a() const noexcept {
  if (!is_on_) return {};
  std::array<double, 3> current{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double share = (duty_[i] - kPwmNeutral) / kPwmSpan;
    current[i] = full_scale_a_ * std::clamp(share, -1.0, 1.0);
  }
  return current;
}

}  // namespace thimble::sim
