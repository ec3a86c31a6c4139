#include "daemon/coupling/wave_arm.hpp"

#include <algorithm>
#include <cmath>

namespace thimble::coupling {
namespace {

// 1/s, ours: what the speed's filter or a stalled servo left out is made up for in 50 ms, and a
// hand at 0.2 m/s is not told more than 4 % too fast for it.
constexpr double kKeepUp = 20;

double within_bounds(double b) noexcept {
  return std::clamp(b, kLeastImpedance_newton_s_per_m, kMostImpedance_newton_s_per_m);
}

}  // namespace

WaveArm::WaveArm(const WaveSettings& settings) noexcept
    : settings_(settings),
      wanted_b_newton_s_per_m_(within_bounds(settings.impedance.newton_s_per_m)),
      b_newton_s_per_m_(wanted_b_newton_s_per_m_),
      port_(settings.age),
      filter_s_(seconds(settings.filter)) {}

void WaveArm::restart(MonotonicTime now, Position3 tip) noexcept {
  port_.reset(now, tip);
  b_newton_s_per_m_ = wanted_b_newton_s_per_m_.load(std::memory_order_relaxed);
  to_world_.restart();
  from_world_.restart();
  filtered_ = {};
  filter_s_ = seconds(settings_.filter);
  impulse_ = {};
  sent_tip_ = is_finite(tip) ? tip : Position3{};
  is_pressing_ = false;
}

bool WaveArm::set_impedance(Damping b) noexcept {
  if (std::isfinite(b.newton_s_per_m)) {
    wanted_b_newton_s_per_m_.store(within_bounds(b.newton_s_per_m), std::memory_order_relaxed);
  }
  return true;
}

ArmOutput WaveArm::advance(const ArmInput& input) noexcept {
  if (!is_finite(input.tip) || !is_finite(input.tip_velocity)) return port_.refuse(input);
  const FarEnd* const far = port_.listen(input);
  if (port_.is_new_epoch()) {
    from_world_.restart();
    filtered_ = {};
    is_pressing_ = false;
    // Who is forgotten takes along what its waves made of our sums, however much that is.
    if (far == nullptr) to_world_.restart();
  }
  if (far != nullptr) {
    from_world_.deliver(far->waves);
    is_pressing_ = far->is_pressing;
  }
  const double dt_s = seconds(input.dt);
  tune(dt_s);
  lengthen_filter(input.link.round_trip);

  const double root = std::sqrt(2 * b_newton_s_per_m_);
  const double share = dt_s / (filter_s_ + dt_s);
  const Velocity3 velocity = velocity_of(input);
  const Wave3 arrived = from_world_.take(dt_s);
  Force3 felt{};
  Wave3 leaving{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    filtered_[axis] += share * (arrived[axis] - filtered_[axis]);
    felt[axis] = root * filtered_[axis] - b_newton_s_per_m_ * velocity[axis];
    leaving[axis] = root * velocity[axis] - filtered_[axis];
    impulse_[axis] -= (felt[axis] + impulse_[axis] / kImpulseMemory_s) * dt_s;
  }
  to_world_.send(leaving, dt_s);

  ArmOutput output = port_.show(input, felt, is_pressing_, {.damping = {b_newton_s_per_m_}});
  output.sample.hand = sent_tip_;
  output.sample.waves = to_world_.sums();
  output.sample.impulse = impulse_;
  return output;
}

void WaveArm::tune(double dt_s) noexcept {
  const double wanted = wanted_b_newton_s_per_m_.load(std::memory_order_relaxed);
  if (b_newton_s_per_m_ == wanted) return;
  const double slide = std::exp(dt_s / seconds(settings_.tuning_time));
  b_newton_s_per_m_ = std::clamp(wanted, b_newton_s_per_m_ / slide, b_newton_s_per_m_ * slide);
}

// What the filter stores is ½·w²/λ: that must not grow by a change of λ.
void WaveArm::lengthen_filter(Duration round_trip) noexcept {
  const double wanted_s = settings_.filter_share * seconds(round_trip) / 2;
  if (!(wanted_s > filter_s_)) return;
  filtered_ = std::sqrt(filter_s_ / wanted_s) * filtered_;
  filter_s_ = wanted_s;
}

Velocity3 WaveArm::velocity_of(const ArmInput& input) noexcept {
  const Displacement3 behind = input.tip - sent_tip_;
  const Velocity3 catch_up{kKeepUp * behind.x, kKeepUp * behind.y, kKeepUp * behind.z};
  const Velocity3 velocity = input.tip_velocity + catch_up;
  const double dt_s = seconds(input.dt);
  sent_tip_ = sent_tip_ + Displacement3{dt_s * velocity.x, dt_s * velocity.y, dt_s * velocity.z};
  return velocity;
}

}  // namespace thimble::coupling
