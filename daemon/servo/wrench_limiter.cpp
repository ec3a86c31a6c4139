#include "daemon/servo/wrench_limiter.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace thimble::servo {
namespace {

constexpr double kHeatKnee = 0.9;  // ours: leaves a tenth of the heat budget for the fall

std::array<double, 3> currents_for(const Matrix3& m, Force3 f) noexcept {
  std::array<double, 3> current_a{};
  for (std::size_t joint = 0; joint < 3; ++joint) {
    current_a[joint] = m.row[joint][0] * f.x + m.row[joint][1] * f.y + m.row[joint][2] * f.z;
  }
  return current_a;
}

bool is_finite(const Matrix3& m) noexcept {
  for (const auto& row : m.row) {
    if (!thimble::is_finite(row[0], row[1], row[2])) return false;
  }
  return true;
}

// See the class comment: a fall is free, everything else moves at most `reach`.
Force3 limit_rise(Force3 previous, Force3 wish, double reach_newton) noexcept {
  const double previous_squared = dot(previous, previous);
  const double share =
      previous_squared > 0 ? std::clamp(dot(wish, previous) / previous_squared, 0.0, 1.0) : 0.0;
  const Force3 start = share * previous;
  const Force3 step = wish - start;
  const double length_newton = norm(step);
  if (length_newton <= reach_newton) return wish;
  return start + (reach_newton / length_newton) * step;
}

}  // namespace

Result<LimiterSettings> make_limiter_settings(const HapticCapabilities& arm,
                                              const LimitRequest& request) {
  LimiterSettings settings;
  if (!std::isfinite(request.force_newton) || request.force_newton < 0) {
    return fail(Errc::InvalidArgument, "limits.force_newton must be a number of at least 0");
  }
  const bool is_force_known = !arm.is_actuated || arm.peak_force_newton > 0;
  if (request.force_newton == 0 && !is_force_known) {
    return fail(Errc::InvalidArgument,
                "the arm's peak force is not known: set limits.force_newton in the configuration");
  }
  settings.max_force_newton =
      arm.peak_force_newton > 0 ? arm.peak_force_newton : request.force_newton;
  if (request.force_newton > 0) {
    settings.max_force_newton = std::min(settings.max_force_newton, request.force_newton);
  }
  if (!(request.rise_newton_per_s > 0) || request.rise_newton_per_s > 1000) {
    return fail(Errc::InvalidArgument,
                "limits.rise_newton_per_s must be above 0 and at most 1000 (it can only tighten)");
  }
  settings.max_rise_newton_per_s = request.rise_newton_per_s;
  if (!arm.is_actuated) {
    settings.max_force_newton = 0;
    // No current flows; heat is counted in shares of something.
    settings.peak_current_a = settings.continuous_current_a = {1, 1, 1};
    return settings;
  }
  for (std::size_t joint = 0; joint < 3; ++joint) {
    const double continuous_a = arm.continuous_current_a[joint];
    double peak_a = arm.peak_current_a[joint];
    const double needed_a = arm.most_current_a_per_newton[joint] * settings.max_force_newton;
    if (!(peak_a > 0) || !(continuous_a > 0) || !std::isfinite(peak_a) || !(needed_a >= 0)) {
      return fail(Errc::InvalidArgument, "motor " + std::to_string(joint + 1) +
                                             " has no current limit: the driver must be told one");
    }
    if (needed_a > 0) peak_a = std::min(peak_a, needed_a);
    settings.peak_current_a[joint] = peak_a;
    settings.continuous_current_a[joint] = std::min(continuous_a, peak_a);
  }
  return settings;
}

double WrenchLimiter::allowed_current_a(std::size_t joint) const noexcept {
  const double peak_a = settings_.peak_current_a[joint];
  const double continuous_a = settings_.continuous_current_a[joint];
  const double over = std::clamp((heat_[joint] - kHeatKnee) / (1.0 - kHeatKnee), 0.0, 1.0);
  return peak_a - over * (peak_a - continuous_a);
}

void WrenchLimiter::advance_heat(const std::array<double, 3>& current_a, Duration dt) noexcept {
  const double share = std::min(1.0, seconds(dt) / seconds(settings_.motor_time_constant));
  for (std::size_t joint = 0; joint < 3; ++joint) {
    const double load = current_a[joint] / settings_.continuous_current_a[joint];
    heat_[joint] += share * (load * load - heat_[joint]);
  }
}

LimitedWrench WrenchLimiter::cut(Duration dt) noexcept {
  previous_ = {};
  advance_heat({}, dt);
  return LimitedWrench::zero();
}

LimiterOutput WrenchLimiter::limit(const LimiterInput& input) noexcept {
  LimiterOutput out;
  if (!thimble::is_finite(input.wish) || !std::isfinite(input.gain)) {
    out.fault = FaultCode::NonFiniteForce;
  } else if (!is_finite(input.motor_current_per_force)) {
    out.fault = FaultCode::NonFiniteState;
  }
  if (out.fault != FaultCode::None) {
    out.wrench = cut(input.dt);
    return out;
  }

  Force3 force = input.wish;
  const double wish_newton = norm(force);
  if (wish_newton > settings_.max_force_newton) {
    force = (settings_.max_force_newton / wish_newton) * force;
    out.is_norm_clamped = true;
  }
  force = std::clamp(input.gain, 0.0, 1.0) * force;

  const Force3 risen =
      limit_rise(previous_, force,
                 settings_.max_rise_newton_per_s * seconds(std::min(input.dt, kLongestRise)));
  out.is_rise_limited = !(risen == force);
  force = risen;

  std::array<double, 3> current_a = currents_for(input.motor_current_per_force, force);
  // Too large to be reckoned with: the heat would be no number from then on, and bound nothing.
  if (!thimble::is_finite(current_a[0], current_a[1], current_a[2])) {
    out.fault = FaultCode::NonFiniteState;
    out.wrench = cut(input.dt);
    return out;
  }
  double scale = 1.0;
  for (std::size_t joint = 0; joint < 3; ++joint) {
    const double allowed_a = allowed_current_a(joint);
    const double asked_a = std::abs(current_a[joint]);
    if (asked_a <= allowed_a) continue;
    scale = std::min(scale, allowed_a / asked_a);
    out.is_current_clamped = true;
    out.is_heat_limited |= allowed_a < settings_.peak_current_a[joint];
  }
  force = scale * force;
  for (double& amperes : current_a) amperes *= scale;

  advance_heat(current_a, input.dt);
  previous_ = force;
  out.wrench = LimitedWrench(force);
  return out;
}

}  // namespace thimble::servo
