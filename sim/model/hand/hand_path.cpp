#include "sim/model/hand/hand_path.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace thimble::sim {
namespace {

// The hand of experiment H2, teleop.md section 4.
constexpr double kSweepReach = 0.045;  // m
constexpr double kSweepSpeed = 0.2;    // m/s

// Physiological tremor of a resting hand: 8 to 12 Hz, tenths of a millimetre. Ours.
constexpr double kTremorAmplitude = 0.1e-3;  // m, of each of three sines
constexpr double kTremorLow = 8;             // Hz
constexpr double kTremorHigh = 12;           // Hz
constexpr double kDriftLow = 0.1;            // Hz
constexpr double kDriftHigh = 0.25;          // Hz
constexpr double kFadeIn = 1;                // s

constexpr double kCircleRampTurns = 0.125;
constexpr double kTurn = 2 * std::numbers::pi;

// SplitMix64 (Steele, Lea, Flood 2014): the standard library's distributions differ between
// implementations, and the same seed must give the same run everywhere.
std::uint64_t next_random(std::uint64_t& state) noexcept {
  state += 0x9e3779b97f4a7c15U;
  std::uint64_t z = state;
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
  return z ^ (z >> 31U);
}

Position3 on_axis(std::size_t axis, double value_m) noexcept {
  Position3 point{};
  point[axis] = value_m;
  return point;
}

}  // namespace

HandPath::HandPath(const HandSettings& settings) noexcept
    : settings_(settings), random_state_(settings.seed) {
  for (std::size_t i = 0; i < kTargets; ++i) order_[i] = i;
  for (auto& axis : sines_) {
    for (std::size_t i = 0; i < kSines; ++i) {
      const bool is_drift = i == 0;
      const double amplitude_m = is_drift ? settings.reach_m / 3 : kTremorAmplitude;
      const double low_hz = is_drift ? kDriftLow : kTremorLow;
      const double high_hz = is_drift ? kDriftHigh : kTremorHigh;
      const double rad_per_s = kTurn * random(low_hz, high_hz);
      axis[i] = {amplitude_m, rad_per_s, random(0, kTurn)};
    }
  }
}

double HandPath::random(double low, double high) noexcept {
  const double unit = static_cast<double>(next_random(random_state_) >> 11U) * 0x1p-53;
  return low + (high - low) * unit;
}

PathPoint HandPath::advance(Duration dt) noexcept {
  elapsed_ += dt;
  stroke_elapsed_ += dt;
  switch (settings_.motion) {
    case HandMotion::Still:
      return {};
    case HandMotion::Circle:
      return circle();
    case HandMotion::Tremor:
      return tremor();
    case HandMotion::Poke:
    case HandMotion::Sweep:
    case HandMotion::Explore:
      return strokes();
  }
  return {};
}

PathPoint HandPath::strokes() noexcept {
  if (stroke_number_ == 0 || seconds(stroke_elapsed_) >= stroke_.duration_s() + pause_s_) {
    next_stroke();
  }
  return stroke_.at(seconds(stroke_elapsed_));
}

void HandPath::next_stroke() noexcept {
  double speed_m_per_s = settings_.speed_m_per_s;
  pause_s_ = 0;
  if (settings_.motion == HandMotion::Sweep) speed_m_per_s = kSweepSpeed;
  if (settings_.motion == HandMotion::Poke) pause_s_ = stroke_number_ % 2 == 0 ? 0.3 : 0.1;
  if (settings_.motion == HandMotion::Explore) {
    speed_m_per_s *= random(0.6, 1);
    pause_s_ = random(0.05, 0.2);
  }
  stroke_ = Stroke(stroke_.end(), next_target(), speed_m_per_s);
  stroke_elapsed_ = {};
  ++stroke_number_;
}

Position3 HandPath::next_target() noexcept {
  const bool is_outward = stroke_number_ % 2 == 0;
  if (settings_.motion == HandMotion::Poke) {
    return is_outward ? on_axis(settings_.axis, settings_.reach_m) : Position3{};
  }
  if (settings_.motion == HandMotion::Sweep) {
    return on_axis(settings_.axis, is_outward ? kSweepReach : -kSweepReach);
  }
  const std::size_t turn = stroke_number_ % kTargets;
  if (turn == 0) shuffle();
  return explore_target(order_[turn]);
}

Position3 HandPath::explore_target(std::size_t index) noexcept {
  const double reach_m = settings_.reach_m;
  if (index >= 6) {
    const std::size_t corner = index - 6;
    const auto side = [&](std::size_t bit) { return (corner & bit) != 0 ? reach_m : -reach_m; };
    return {side(1), side(2), side(4)};
  }
  Position3 face{};
  for (std::size_t axis = 0; axis < 3; ++axis) face[axis] = random(-0.5, 0.5) * reach_m;
  face[index / 2] = index % 2 == 0 ? reach_m : -reach_m;
  return face;
}

void HandPath::shuffle() noexcept {
  for (std::size_t i = kTargets - 1; i > 0; --i) {
    const auto j = static_cast<std::size_t>(next_random(random_state_) % (i + 1));
    std::swap(order_[i], order_[j]);
  }
}

PathPoint HandPath::circle() const noexcept {
  const double radius_m = settings_.reach_m;
  if (radius_m <= 0) return {};
  const Stroke outward({}, {radius_m, 0, 0}, settings_.speed_m_per_s);
  const double t_s = seconds(elapsed_) - outward.duration_s();
  if (t_s < 0) return outward.at(seconds(elapsed_));
  // The angular speed rises linearly over the first part of a turn, then stays.
  const double cruise_rad_per_s = settings_.speed_m_per_s / radius_m;
  const double ramp_s = 2 * kTurn * kCircleRampTurns / cruise_rad_per_s;
  const double rising_s = std::min(t_s, ramp_s);
  const double rate = cruise_rad_per_s * rising_s / ramp_s;
  const double angle_rad = 0.5 * rate * rising_s + cruise_rad_per_s * (t_s - rising_s);
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  return {{radius_m * c, radius_m * s, 0}, {-radius_m * rate * s, radius_m * rate * c, 0}};
}

PathPoint HandPath::tremor() const noexcept {
  const double t_s = seconds(elapsed_);
  const double u = std::min(1.0, t_s / kFadeIn);
  const double gain = u * u * (3 - 2 * u);
  const double gain_rate = 6 * u * (1 - u) / kFadeIn;
  PathPoint point{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double value_m = 0;
    double rate_m_per_s = 0;
    for (const Sine& sine : sines_[axis]) {
      const double angle_rad = sine.rad_per_s * t_s + sine.phase_rad;
      value_m += sine.amplitude_m * std::sin(angle_rad);
      rate_m_per_s += sine.amplitude_m * sine.rad_per_s * std::cos(angle_rad);
    }
    point.position[axis] = gain * value_m;
    point.velocity[axis] = gain_rate * value_m + gain * rate_m_per_s;
  }
  return point;
}

}  // namespace thimble::sim
