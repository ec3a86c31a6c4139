#pragma once

#include "hal/base/geometry.hpp"
#include "hal/rt/annotations.hpp"
#include "sim/model/arm/arm_dynamics.hpp"

namespace thimble::sim {

// The moving arm: joint angles and rates under motor torques, a force at the tip, friction,
// gravity and end stops; the midpoint method with inputs held over a step (decision 0500).
//
// Thread: one. RT: step() and all readers. Ownership: by value, no allocation after construction.
class ArmPlant {
 public:
  explicit ArmPlant(const ArmParameters& parameters);

  // Puts the arm into a pose at rest.
  THIMBLE_RT void rest_at(const JointVector& q_rad) noexcept;
  THIMBLE_RT void set_state(const JointVector& q_rad, const JointVector& rate) noexcept;
  // `dt_s` in (0, 1e-4]: the stops' stiffness bounds it. Force: N, base frame.
  THIMBLE_RT void step(double dt_s, const JointVector& motor_torque, Force3 tip_force) noexcept;

  [[nodiscard]] const JointVector& joint_rad() const noexcept { return q_; }
  [[nodiscard]] const JointVector& joint_rate() const noexcept { return rate_; }
  THIMBLE_RT [[nodiscard]] Position3 tip() const noexcept;
  THIMBLE_RT [[nodiscard]] Velocity3 tip_velocity() const noexcept;
  // Kinetic, potential and what the end stops have stored.
  THIMBLE_RT [[nodiscard]] double mechanical_energy_j() const noexcept;
  [[nodiscard]] const ArmDynamics::Pose& pose() const noexcept { return pose_; }
  [[nodiscard]] const ArmDynamics& dynamics() const noexcept { return dynamics_; }

 private:
  // Steps between two poses that are computed from the angles: in between each follows from the
  // one before.
  static constexpr int kStepsToExactPose = 20;

  [[nodiscard]] JointVector acceleration(const ArmDynamics::Pose& pose, const JointVector& q,
                                         const JointVector& rate, const JointVector& motor_torque,
                                         Force3 tip_force) const noexcept;
  void move_by(const JointVector& step_rad) noexcept;
  [[nodiscard]] JointVector friction(const JointVector& rate) const noexcept;
  void add_stops(const JointVector& q, const JointVector& rate, JointVector& torque) const noexcept;

  ArmDynamics dynamics_;
  JointVector coulomb_newton_m_{};
  JointVector viscous_newton_m_s_{};
  JointVector q_{};
  JointVector rate_{};
  ArmDynamics::Pose pose_{};  // of q_
  int steps_since_exact_{0};
};

}  // namespace thimble::sim
