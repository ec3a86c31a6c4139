#include "sim/model/falcon/delta_plant.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace thimble::sim {
namespace {

// Ours: far beyond what a hand or these motors reach; more is a defect, and the arm stands.
constexpr double kFastest_rad_per_s = 300;

double square(double value) noexcept { return value * value; }

// Push of a stop, `in` deep (<= 0: not touched), growing `rate` deeper.
double stop_push(double in, double rate, double stiffness, double damping_s) noexcept {
  return in > 0 ? std::max(stiffness * in * (1 + damping_s * rate), 0.0) : 0;
}

double stop_energy_j(double in, double stiffness) noexcept {
  return in > 0 ? stiffness * square(in) / 2 : 0;
}

// Its columns: how the grip moves when one crank turns.
Matrix3 jacobian_of(const DeltaLinkage::Pose& pose) noexcept {
  Matrix3 jacobian = pose.a_inverse;
  for (auto& row : jacobian.row) {
    for (std::size_t i = 0; i < 3; ++i) row[i] *= -pose.constraint.b[i];
  }
  return jacobian;
}

}  // namespace

DeltaPlant::DeltaPlant(const FalconParameters& parameters) : p_(parameters), linkage_(parameters) {
  const double knee_kg = p_.rods_kg / 2;
  crank_kg_m2_ =
      (p_.crank_kg / 3 + knee_kg) * square(p_.crank_m) + p_.rotor_kg_m2 * square(p_.drive_ratio);
  crank_moment_kg_m_ = (p_.crank_kg / 2 + knee_kg) * p_.crank_m;
  grip_kg_ = p_.grip_kg + 3 * p_.rods_kg / 2;
  for (std::size_t i = 0; i < 3; ++i) {
    lean_[i] = std::sin(p_.azimuth_rad[i]);
  }
}

bool DeltaPlant::rest_at(const Triple& x) noexcept {
  const std::optional<Triple> q = linkage_.inverse(x);
  if (!q.has_value() || std::hypot(x.x, x.y) > p_.rim_m) return false;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!((*q)[i] >= p_.crank_min_rad && (*q)[i] <= p_.crank_max_rad)) return false;
  }
  const auto pose = linkage_.forward(DeltaLinkage::cranks(*q), x);
  if (!pose.has_value()) return false;
  q_ = *q;
  rate_ = {};
  pose_ = *pose;
  steps_since_exact_ = 0;
  return true;
}

Triple DeltaPlant::crank_torques(const Triple& q, const Triple& sine,
                                 const Triple& rate) const noexcept {
  Triple torque;
  for (std::size_t i = 0; i < 3; ++i) {
    const double weight = crank_moment_kg_m_ * p_.gravity_m_per_s2 * sine[i] * lean_[i];
    const double rub = p_.coulomb_newton_m * rate[i] /
                           std::sqrt(square(rate[i]) + square(p_.friction_knee_rad_per_s)) +
                       p_.viscous_newton_m_s_per_rad * rate[i];
    torque[i] = weight - rub +
                stop_push(p_.crank_min_rad - q[i], -rate[i], p_.crank_stop_newton_m_per_rad,
                          p_.stop_damping_s) -
                stop_push(q[i] - p_.crank_max_rad, rate[i], p_.crank_stop_newton_m_per_rad,
                          p_.stop_damping_s);
  }
  return torque;
}

Triple DeltaPlant::grip_forces(const Triple& x, const Triple& velocity) const noexcept {
  Triple force{0, -grip_kg_ * p_.gravity_m_per_s2, 0};
  const double off_axis_m = std::hypot(x.x, x.y);
  if (off_axis_m <= p_.rim_m) return force;
  const Triple outward{x.x / off_axis_m, x.y / off_axis_m, 0};
  force -= stop_push(off_axis_m - p_.rim_m, dot(outward, velocity), p_.rim_newton_per_m,
                     p_.stop_damping_s) *
           outward;
  return force;
}

Matrix3 DeltaPlant::mass_matrix(const Matrix3& jacobian) const noexcept {
  Matrix3 mass = square_of(jacobian);
  for (std::size_t i = 0; i < 3; ++i) {
    for (double& term : mass.row[i]) term *= grip_kg_;
    mass.row[i][i] += crank_kg_m2_;
  }
  return mass;
}

DeltaPlant::Stage DeltaPlant::evaluate(const Triple& q, const Triple& rate,
                                       const DeltaLinkage::Pose& pose,
                                       const Inputs& in) const noexcept {
  const Matrix3 jacobian = jacobian_of(pose);
  Stage stage{times(jacobian, rate), {}};
  const Triple bias = linkage_.bias(pose.cranks, pose.constraint, rate, stage.velocity);
  const Triple drift = -times(pose.a_inverse, bias);
  const Triple force = in.grip_force + grip_forces(pose.x, stage.velocity) - grip_kg_ * drift;
  const Triple torque = in.motor_torque + crank_torques(q, pose.cranks.sine, rate) +
                        transposed_times(jacobian, force);
  stage.acceleration = solved(mass_matrix(jacobian), torque);
  return stage;
}

void DeltaPlant::step(double dt_s, const Triple& motor_torque, const Triple& grip_force) noexcept {
  if (!pose_.has_value()) {
    ++standstills_;
    return;
  }
  const Inputs in{motor_torque, grip_force};
  const double half_s = dt_s / 2;
  const Stage begin = evaluate(q_, rate_, *pose_, in);
  const Triple half_way = half_s * rate_;
  const auto half_pose = linkage_.forward(DeltaLinkage::turned(pose_->cranks, half_way),
                                          pose_->x + half_s * begin.velocity);
  if (!half_pose.has_value()) return stand_still();
  const Triple half_rate = rate_ + half_s * begin.acceleration;
  const Stage middle = evaluate(q_ + half_way, half_rate, *half_pose, in);
  const Triple way = dt_s * half_rate;
  const Triple rate = rate_ + dt_s * middle.acceleration;
  const auto pose = linkage_.forward(cranks_after(way), pose_->x + dt_s * middle.velocity);
  if (!pose.has_value() || !(norm(rate) <= kFastest_rad_per_s)) return stand_still();
  steps_since_exact_ = (steps_since_exact_ + 1) % kStepsToExactCranks;
  q_ += way;
  rate_ = rate;
  pose_ = *pose;
}

DeltaLinkage::Cranks DeltaPlant::cranks_after(const Triple& way_rad) const noexcept {
  return steps_since_exact_ + 1 == kStepsToExactCranks
             ? DeltaLinkage::cranks(q_ + way_rad)
             : DeltaLinkage::turned(pose_->cranks, way_rad);
}

void DeltaPlant::stand_still() noexcept {
  rate_ = {};
  ++standstills_;
}

Matrix3 DeltaPlant::jacobian() const noexcept {
  return pose_.has_value() ? jacobian_of(*pose_) : Matrix3{};
}

Triple DeltaPlant::grip_velocity() const noexcept { return times(jacobian(), rate_); }

Triple DeltaPlant::force_of(const Triple& torque) const noexcept {
  if (!pose_.has_value()) return {};
  // F = J^-T torque, and J^-T = -A^T diag(1/b).
  const DeltaLinkage::Constraint& c = pose_->constraint;
  const Triple force = -transposed_times(c.a, each_over(torque, c.b));
  return is_finite(force) ? force : Triple{};
}

double DeltaPlant::mechanical_energy_j() const noexcept {
  const Triple x = grip();
  double energy_j =
      dot(rate_, times(mass_matrix(jacobian()), rate_)) / 2 + grip_kg_ * p_.gravity_m_per_s2 * x.y;
  for (std::size_t i = 0; i < 3; ++i) {
    energy_j += crank_moment_kg_m_ * p_.gravity_m_per_s2 * std::cos(q_[i]) * lean_[i] +
                stop_energy_j(p_.crank_min_rad - q_[i], p_.crank_stop_newton_m_per_rad) +
                stop_energy_j(q_[i] - p_.crank_max_rad, p_.crank_stop_newton_m_per_rad);
  }
  return energy_j + stop_energy_j(std::hypot(x.x, x.y) - p_.rim_m, p_.rim_newton_per_m);
}

}  // namespace thimble::sim
