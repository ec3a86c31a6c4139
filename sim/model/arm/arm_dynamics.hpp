#pragma once

#include <array>
#include <optional>

#include "hal/base/geometry.hpp"
#include "hal/rt/annotations.hpp"
#include "sim/model/arm/arm_parameters.hpp"

namespace thimble::sim {

// M(q) of the arm, kg m². A couples to neither B nor C: the arm moves in a turning plane.
struct MassMatrix {
  double aa{}, bb{}, bc{}, cc{};
};

// Tip velocity per joint rate, base frame: jacobian[axis][joint], m/rad.
using TipJacobian = std::array<std::array<double, 3>, 3>;

// The equations of motion of a two-link parallelogram arm on a turret, in joint space:
//   M(q) q'' + c(q, q') + dV/dq = torques.
// README.md derives them. Frames: the fact sheet's device frame (x away from the base, z up)
// is turned into Thimble's arm base frame here: x = y_dev, y = z_dev, z = x_dev.
//
// Thread: immutable, any. RT: all but the constructor. Errors: none; total over finite angles.
class ArmDynamics {
 public:
  explicit ArmDynamics(const ArmParameters& parameters);

  // Sines and cosines of one pose; everything below is a polynomial in them.
  struct Pose {
    double sin_a{}, cos_a{}, sin_b{}, cos_b{}, sin_c{}, cos_c{};
  };
  THIMBLE_RT [[nodiscard]] static Pose pose(const JointVector& q_rad) noexcept;
  // The pose further on by `step_rad`, without a sine or cosine where every step is small: to the
  // last bit or two, so that dozens of them in a row are as good as pose().
  THIMBLE_RT [[nodiscard]] static Pose turned(const Pose& from,
                                              const JointVector& step_rad) noexcept;

  THIMBLE_RT [[nodiscard]] Position3 tip(const Pose& pose) const noexcept;
  THIMBLE_RT [[nodiscard]] TipJacobian jacobian(const Pose& pose) const noexcept;
  // Joint torques of a force at the tip: J^T F, N m.
  THIMBLE_RT [[nodiscard]] JointVector torque_of(const Pose& pose, Force3 force) const noexcept;
  // The force at the tip that joint torques amount to: J^-T tau. Zero where J is singular.
  THIMBLE_RT [[nodiscard]] Force3 force_of(const Pose& pose,
                                           const JointVector& torque) const noexcept;
  // Pose that puts the tip there, elbow up; nothing when no pose within the stops does.
  THIMBLE_RT [[nodiscard]] std::optional<JointVector> inverse(Position3 tip) const noexcept;

  THIMBLE_RT [[nodiscard]] MassMatrix mass_matrix(const Pose& pose) const noexcept;
  // c(q, q'): Coriolis and centrifugal torques, N m.
  THIMBLE_RT [[nodiscard]] JointVector coriolis(const Pose& pose,
                                                const JointVector& rate) const noexcept;
  THIMBLE_RT [[nodiscard]] JointVector gravity_gradient(const Pose& pose) const noexcept;
  THIMBLE_RT [[nodiscard]] static JointVector solve(const MassMatrix& mass,
                                                    const JointVector& torque) noexcept;

  THIMBLE_RT [[nodiscard]] double kinetic_energy_j(const Pose& pose,
                                                   const JointVector& rate) const noexcept;
  THIMBLE_RT [[nodiscard]] double potential_energy_j(const Pose& pose) const noexcept;

  [[nodiscard]] const ArmParameters& parameters() const noexcept { return parameters_; }
  [[nodiscard]] bool is_within_stops(const JointVector& q_rad) const noexcept;

 private:
  ArmParameters parameters_;
  // Coefficients of T and V, see README.md.
  double turret_kg_m2_{}, upper_kg_m2_{}, fore_kg_m2_{}, cross_kg_m2_{};
  double rotor_b_kg_m2_{}, rotor_c_kg_m2_{};
  double weight_b_newton_m_{}, weight_c_newton_m_{};
};

}  // namespace thimble::sim
