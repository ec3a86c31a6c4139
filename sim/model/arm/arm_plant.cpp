#include "sim/model/arm/arm_plant.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace thimble::sim {
namespace {

JointVector plus(const JointVector& a, double scale, const JointVector& b) noexcept {
  return {a[0] + scale * b[0], a[1] + scale * b[1], a[2] + scale * b[2]};
}

JointVector scaled(double scale, const JointVector& a) noexcept {
  return {scale * a[0], scale * a[1], scale * a[2]};
}

// How far `angle` is beyond the range: > 0 above, < 0 below, 0 inside.
double beyond(const AngleRange& range, double angle_rad) noexcept {
  if (angle_rad > range.max_rad) return angle_rad - range.max_rad;
  if (angle_rad < range.min_rad) return angle_rad - range.min_rad;
  return 0;
}

// A stiff stop that only ever pushes back: k x (1 + b x'), never below zero.
double stop_torque(const ArmParameters& p, double excess_rad, double rate) noexcept {
  const double growth = 1 + p.stop_damping_s_per_rad * (excess_rad > 0 ? rate : -rate);
  return -p.stop_newton_m_per_rad * excess_rad * std::max(0.0, growth);
}

}  // namespace

ArmPlant::ArmPlant(const ArmParameters& parameters) : dynamics_(parameters) {
  const TipJacobian j = dynamics_.jacobian(ArmDynamics::pose(parameters.home_rad));
  for (std::size_t i = 0; i < 3; ++i) {
    // What is felt at the tip in the home pose, carried to the joint over its lever there.
    const double lever_m = norm(j[0][i], j[1][i], j[2][i]);
    coulomb_newton_m_[i] = parameters.backdrive_newton * lever_m;
    viscous_newton_m_s_[i] = parameters.viscous_newton_s_per_m * lever_m * lever_m;
  }
  rest_at(parameters.parked_rad);
}

void ArmPlant::rest_at(const JointVector& q_rad) noexcept { set_state(q_rad, {}); }

void ArmPlant::set_state(const JointVector& q_rad, const JointVector& rate) noexcept {
  q_ = q_rad;
  rate_ = rate;
  pose_ = ArmDynamics::pose(q_);
  steps_since_exact_ = 0;
}

void ArmPlant::move_by(const JointVector& step_rad) noexcept {
  q_ = plus(q_, 1, step_rad);
  ++steps_since_exact_;
  if (steps_since_exact_ < kStepsToExactPose) {
    pose_ = ArmDynamics::turned(pose_, step_rad);
    return;
  }
  steps_since_exact_ = 0;
  pose_ = ArmDynamics::pose(q_);
}

JointVector ArmPlant::friction(const JointVector& rate) const noexcept {
  const double knee = dynamics_.parameters().friction_knee_rad_per_s;
  JointVector torque{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double smooth_sign = rate[i] / std::sqrt(rate[i] * rate[i] + knee * knee);
    torque[i] = -coulomb_newton_m_[i] * smooth_sign - viscous_newton_m_s_[i] * rate[i];
  }
  return torque;
}

void ArmPlant::add_stops(const JointVector& q, const JointVector& rate,
                         JointVector& torque) const noexcept {
  const ArmParameters& p = dynamics_.parameters();
  for (std::size_t i = 0; i < 3; ++i) {
    const double excess_rad = beyond(p.joint_range[i], q[i]);
    if (excess_rad != 0) torque[i] += stop_torque(p, excess_rad, rate[i]);
  }
  const double excess_rad = beyond(p.elbow_range, q[1] + q[2]);
  if (excess_rad == 0) return;
  const double elbow_torque = stop_torque(p, excess_rad, rate[1] + rate[2]);
  torque[1] += elbow_torque;
  torque[2] += elbow_torque;
}

JointVector ArmPlant::acceleration(const ArmDynamics::Pose& pose, const JointVector& q,
                                   const JointVector& rate, const JointVector& motor_torque,
                                   Force3 tip_force) const noexcept {
  const JointVector drag = friction(rate);
  const JointVector coriolis = dynamics_.coriolis(pose, rate);
  const JointVector gravity = dynamics_.gravity_gradient(pose);
  const JointVector pushed = dynamics_.torque_of(pose, tip_force);
  JointVector torque{};
  for (std::size_t i = 0; i < 3; ++i) {
    torque[i] = motor_torque[i] + pushed[i] + drag[i] - coriolis[i] - gravity[i];
  }
  add_stops(q, rate, torque);
  return ArmDynamics::solve(dynamics_.mass_matrix(pose), torque);
}

void ArmPlant::step(double dt_s, const JointVector& motor_torque, Force3 tip_force) noexcept {
  const double half_s = dt_s / 2;
  const JointVector begin = acceleration(pose_, q_, rate_, motor_torque, tip_force);
  const JointVector half_rate = plus(rate_, half_s, begin);
  const JointVector way = scaled(half_s, rate_);
  const JointVector middle = acceleration(ArmDynamics::turned(pose_, way), plus(q_, 1, way),
                                          half_rate, motor_torque, tip_force);
  move_by(scaled(dt_s, half_rate));
  rate_ = plus(rate_, dt_s, middle);
}

Position3 ArmPlant::tip() const noexcept { return dynamics_.tip(pose_); }

Velocity3 ArmPlant::tip_velocity() const noexcept {
  const TipJacobian j = dynamics_.jacobian(pose_);
  Velocity3 velocity{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    velocity[axis] = j[axis][0] * rate_[0] + j[axis][1] * rate_[1] + j[axis][2] * rate_[2];
  }
  return velocity;
}

double ArmPlant::mechanical_energy_j() const noexcept {
  const ArmParameters& p = dynamics_.parameters();
  double excess_squared = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double excess_rad = beyond(p.joint_range[i], q_[i]);
    excess_squared += excess_rad * excess_rad;
  }
  const double elbow_rad = beyond(p.elbow_range, q_[1] + q_[2]);
  excess_squared += elbow_rad * elbow_rad;
  return dynamics_.kinetic_energy_j(pose_, rate_) + dynamics_.potential_energy_j(pose_) +
         0.5 * p.stop_newton_m_per_rad * excess_squared;
}

}  // namespace thimble::sim
