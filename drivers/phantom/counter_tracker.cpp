#include "drivers/phantom/counter_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace thimble::phantom {
namespace {

// The shortest way from `before` to `after` round the 16-bit circle.
std::int32_t wrapped_step(std::int16_t before, std::int16_t after) noexcept {
  const auto difference = static_cast<std::uint16_t>(static_cast<std::uint16_t>(after) -
                                                     static_cast<std::uint16_t>(before));
  return static_cast<std::int16_t>(difference);
}

// Bounded so that a sum of two, or one and a step, fits.
std::int32_t whole_counts(double counts) noexcept {
  constexpr double kFarthest_counts = 1 << 29;
  return static_cast<std::int32_t>(std::clamp(counts, -kFarthest_counts, kFarthest_counts));
}

}  // namespace

CounterTracker::CounterTracker(const PhantomModel& model) noexcept {
  for (std::size_t i = 0; i < 3; ++i) {
    const double counts_per_motor_rad = model.counts_per_motor_rev[i] / (2 * std::numbers::pi);
    limit_counts_per_s_[i] = model.motor_speed_limit_rad_per_s * counts_per_motor_rad;
    const double counts_per_rad = model.motor_direction[i] * counts_per_motor_rad *
                                  model.drum_diameter_m[i] / model.capstan_diameter_m[i];
    const double home_rad = model.home_angle_rad[i];
    const std::int32_t one_end =
        whole_counts((model.joint_min_rad[i] - kMargin_rad - home_rad) * counts_per_rad);
    const std::int32_t other_end =
        whole_counts((model.joint_max_rad[i] + kMargin_rad - home_rad) * counts_per_rad);
    range_[i] = {std::min(one_end, other_end), std::max(one_end, other_end)};
  }
}

void CounterTracker::restart(const Raw& raw) noexcept {
  last_ = raw;
  for (std::size_t i = 0; i < 3; ++i) counts_[i] = {raw[i]};
}

std::int32_t CounterTracker::largest_step(std::size_t motor, Duration elapsed) const noexcept {
  const double time_s = std::max(0.0, seconds(elapsed)) + seconds(kSlack);
  const double bound = limit_counts_per_s_[motor] * time_s;
  return static_cast<std::int32_t>(std::min<double>(bound, range_[motor].max - range_[motor].min));
}

bool CounterTracker::follow(const Raw& raw, Duration elapsed) noexcept {
  std::array<std::int32_t, 3> step{};
  std::int32_t widest = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    step[i] = wrapped_step(last_[i], raw[i]);
    widest = std::max(widest, std::abs(step[i]));
    const std::int32_t largest = largest_step(i, elapsed);
    if (largest > kHalfRange_counts || std::abs(step[i]) > largest) return false;
    const std::int32_t now = counts_[i].value + step[i];
    if (now < range_[i].min || now > range_[i].max) return false;
  }
  if (raw == Raw{} && widest > kResetStep_counts) return false;
  last_ = raw;
  for (std::size_t i = 0; i < 3; ++i) counts_[i].value += step[i];
  return true;
}

}  // namespace thimble::phantom
