#include "sim/model/arm/arm_dynamics.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "sim/model/arm/sine_cosine.hpp"

namespace thimble::sim {
namespace {

constexpr double kSingular = 1e-9;  // m²: below it the tip cannot be pushed in some direction

double square(double value) noexcept { return value * value; }

}  // namespace

ArmDynamics::ArmDynamics(const ArmParameters& parameters) : parameters_(parameters) {
  const ArmParameters& p = parameters_;
  const double upper_m = p.link_m[1];
  const double fore_m = p.link_m[2];
  const double outer_kg = p.forearm_kg + p.tip_kg;
  // First moments about the elbow (forearm) and the shoulder (upper arm with what it carries).
  const double fore_moment = p.forearm_kg * fore_m / 2 + p.tip_kg * fore_m;
  const double upper_moment = p.upper_arm_kg * upper_m / 2 + outer_kg * upper_m;
  // A counterweight of first moment `balance * moment` at its radius adds moment * radius.
  const double upper_counter = p.balance * upper_moment * p.counterweight_radius_m;
  const double fore_counter = p.balance * fore_moment * p.counterweight_radius_m;

  upper_kg_m2_ = p.upper_arm_kg * square(upper_m) / 3 + outer_kg * square(upper_m) + upper_counter;
  fore_kg_m2_ = p.forearm_kg * square(fore_m) / 3 + p.tip_kg * square(fore_m) + fore_counter;
  cross_kg_m2_ = upper_m * fore_moment;
  turret_kg_m2_ = p.turret_kg_m2 + p.rotor_kg_m2[0] * square(p.drive_ratio[0]);
  rotor_b_kg_m2_ = p.rotor_kg_m2[1] * square(p.drive_ratio[1]);
  rotor_c_kg_m2_ = p.rotor_kg_m2[2] * square(p.drive_ratio[2]);
  weight_b_newton_m_ = (1 - p.balance) * upper_moment * p.gravity_m_per_s2;
  weight_c_newton_m_ = (1 - p.balance) * fore_moment * p.gravity_m_per_s2;
}

ArmDynamics::Pose ArmDynamics::pose(const JointVector& q) noexcept {
  return {std::sin(q[0]), std::cos(q[0]), std::sin(q[1]),
          std::cos(q[1]), std::sin(q[2]), std::cos(q[2])};
}

ArmDynamics::Pose ArmDynamics::turned(const Pose& from, const JointVector& step) noexcept {
  const SineCosine a = SineCosine{from.sin_a, from.cos_a}.after(sine_cosine_of(step[0]));
  const SineCosine b = SineCosine{from.sin_b, from.cos_b}.after(sine_cosine_of(step[1]));
  const SineCosine c = SineCosine{from.sin_c, from.cos_c}.after(sine_cosine_of(step[2]));
  return {a.sine, a.cosine, b.sine, b.cosine, c.sine, c.cosine};
}

Position3 ArmDynamics::tip(const Pose& s) const noexcept {
  const auto& [base_m, upper_m, fore_m] = parameters_.link_m;
  const auto& [ox, oy, oz] = parameters_.origin_m;
  const double radial_m = upper_m * s.sin_b + fore_m * s.sin_c;
  const double height_m = base_m + upper_m * s.cos_b - fore_m * s.cos_c;
  return {s.sin_a * radial_m - oy, height_m - oz, s.cos_a * radial_m - ox};
}

TipJacobian ArmDynamics::jacobian(const Pose& s) const noexcept {
  const double upper_m = parameters_.link_m[1];
  const double fore_m = parameters_.link_m[2];
  const double radial_m = upper_m * s.sin_b + fore_m * s.sin_c;
  return {{{s.cos_a * radial_m, s.sin_a * upper_m * s.cos_b, s.sin_a * fore_m * s.cos_c},
           {0, -upper_m * s.sin_b, fore_m * s.sin_c},
           {-s.sin_a * radial_m, s.cos_a * upper_m * s.cos_b, s.cos_a * fore_m * s.cos_c}}};
}

JointVector ArmDynamics::torque_of(const Pose& s, Force3 force) const noexcept {
  const double upper_m = parameters_.link_m[1];
  const double fore_m = parameters_.link_m[2];
  const double radial_m = upper_m * s.sin_b + fore_m * s.sin_c;
  const double across = s.cos_a * force.x - s.sin_a * force.z;
  const double outward = s.sin_a * force.x + s.cos_a * force.z;
  return {radial_m * across, upper_m * (s.cos_b * outward - s.sin_b * force.y),
          fore_m * (s.cos_c * outward + s.sin_c * force.y)};
}

Force3 ArmDynamics::force_of(const Pose& s, const JointVector& torque) const noexcept {
  const double upper_m = parameters_.link_m[1];
  const double fore_m = parameters_.link_m[2];
  const double radial_m = upper_m * s.sin_b + fore_m * s.sin_c;
  const double sin_elbow = s.cos_b * s.sin_c + s.sin_b * s.cos_c;
  if (std::abs(radial_m * radial_m) < kSingular ||
      std::abs(upper_m * fore_m * sin_elbow) < kSingular) {
    return {};
  }
  const double across = torque[0] / radial_m;
  const double outward = (s.sin_c * torque[1] / upper_m + s.sin_b * torque[2] / fore_m) / sin_elbow;
  const double up = (s.cos_b * torque[2] / fore_m - s.cos_c * torque[1] / upper_m) / sin_elbow;
  return {s.cos_a * across + s.sin_a * outward, up, s.cos_a * outward - s.sin_a * across};
}

std::optional<JointVector> ArmDynamics::inverse(Position3 tip) const noexcept {
  const auto& [base_m, upper_m, fore_m] = parameters_.link_m;
  const auto& [ox, oy, oz] = parameters_.origin_m;
  if (!is_finite(tip)) return std::nullopt;
  const double forward_m = tip.z + ox;
  const double across_m = tip.x + oy;
  const double radial_m = std::hypot(forward_m, across_m);
  const double height_m = tip.y + oz - base_m;
  const double span_m = std::hypot(radial_m, height_m);
  if (span_m < kSingular) return std::nullopt;
  const double cos_lift =
      (square(upper_m) + square(span_m) - square(fore_m)) / (2 * upper_m * span_m);
  if (!(std::abs(cos_lift) <= 1)) return std::nullopt;
  const double elevation_rad = std::atan2(height_m, radial_m) + std::acos(cos_lift);
  const double b_rad = std::numbers::pi / 2 - elevation_rad;
  const double c_rad =
      std::atan2(radial_m - upper_m * std::sin(b_rad), upper_m * std::cos(b_rad) - height_m);
  const JointVector q{std::atan2(across_m, forward_m), b_rad, c_rad};
  if (!is_within_stops(q)) return std::nullopt;
  return q;
}

MassMatrix ArmDynamics::mass_matrix(const Pose& s) const noexcept {
  const double cos_elbow = s.cos_b * s.cos_c - s.sin_b * s.sin_c;
  return {turret_kg_m2_ + upper_kg_m2_ * square(s.sin_b) + fore_kg_m2_ * square(s.sin_c) +
              2 * cross_kg_m2_ * s.sin_b * s.sin_c,
          upper_kg_m2_ + rotor_b_kg_m2_, cross_kg_m2_ * cos_elbow, fore_kg_m2_ + rotor_c_kg_m2_};
}

JointVector ArmDynamics::coriolis(const Pose& s, const JointVector& rate) const noexcept {
  const double daa_db = 2 * s.cos_b * (upper_kg_m2_ * s.sin_b + cross_kg_m2_ * s.sin_c);
  const double daa_dc = 2 * s.cos_c * (fore_kg_m2_ * s.sin_c + cross_kg_m2_ * s.sin_b);
  const double dbc = -cross_kg_m2_ * (s.sin_b * s.cos_c + s.cos_b * s.sin_c);
  const double half_a2 = 0.5 * square(rate[0]);
  return {(daa_db * rate[1] + daa_dc * rate[2]) * rate[0], dbc * square(rate[2]) - daa_db * half_a2,
          dbc * square(rate[1]) - daa_dc * half_a2};
}

JointVector ArmDynamics::gravity_gradient(const Pose& s) const noexcept {
  return {0, -weight_b_newton_m_ * s.sin_b, weight_c_newton_m_ * s.sin_c};
}

JointVector ArmDynamics::solve(const MassMatrix& m, const JointVector& torque) noexcept {
  const double inverse_determinant = 1 / (m.bb * m.cc - m.bc * m.bc);
  return {torque[0] / m.aa, (m.cc * torque[1] - m.bc * torque[2]) * inverse_determinant,
          (m.bb * torque[2] - m.bc * torque[1]) * inverse_determinant};
}

double ArmDynamics::kinetic_energy_j(const Pose& s, const JointVector& rate) const noexcept {
  const MassMatrix m = mass_matrix(s);
  return 0.5 * (m.aa * square(rate[0]) + m.bb * square(rate[1]) + m.cc * square(rate[2])) +
         m.bc * rate[1] * rate[2];
}

double ArmDynamics::potential_energy_j(const Pose& s) const noexcept {
  return weight_b_newton_m_ * s.cos_b - weight_c_newton_m_ * s.cos_c;
}

bool ArmDynamics::is_within_stops(const JointVector& q) const noexcept {
  for (std::size_t i = 0; i < 3; ++i) {
    const AngleRange& range = parameters_.joint_range[i];
    if (!(q[i] >= range.min_rad && q[i] <= range.max_rad)) return false;
  }
  const double elbow_rad = q[1] + q[2];
  return elbow_rad >= parameters_.elbow_range.min_rad &&
         elbow_rad <= parameters_.elbow_range.max_rad;
}

}  // namespace thimble::sim
