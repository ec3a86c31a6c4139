#pragma once

#include <cstdint>
#include <optional>

#include "hal/rt/annotations.hpp"
#include "sim/model/falcon/delta_linkage.hpp"
#include "sim/model/falcon/falcon_parameters.hpp"
#include "sim/model/falcon/triple.hpp"

namespace thimble::sim {

// The moving delta arm: three cranks and the grip that their rods carry, under motor torques, a
// force at the grip, friction, gravity and stops. In joint space, for q the cranks' angles:
//
//   (I + m JᵀJ) q" + m Jᵀ(x" at q" = 0) + dV/dq = motors + JᵀF + friction + stops
//
// by the midpoint method with inputs held over a step (decision 0500). README.md has the masses.
// Frame: the device's. Units: SI.
//
// Thread: one. RT: all but the constructor. Ownership: by value, no allocation.
// Errors: where the equations have no solution the arm stands still, and that is counted.
class DeltaPlant {
 public:
  explicit DeltaPlant(const FalconParameters& parameters);

  // Puts the grip there, at rest; before that there is no motion. False, and nothing changes: out
  // of reach.
  THIMBLE_RT bool rest_at(const Triple& x) noexcept;
  THIMBLE_RT void set_rate(const Triple& rate) noexcept { rate_ = rate; }
  // `dt_s` in (0, 1e-4]: the stops' stiffness bounds it. Torque of each crank, N m; force, N.
  THIMBLE_RT void step(double dt_s, const Triple& motor_torque, const Triple& grip_force) noexcept;

  [[nodiscard]] const Triple& crank_rad() const noexcept { return q_; }
  [[nodiscard]] const Triple& crank_rate() const noexcept { return rate_; }
  [[nodiscard]] Triple grip() const noexcept { return pose_ ? pose_->x : Triple{}; }
  THIMBLE_RT [[nodiscard]] Triple grip_velocity() const noexcept;
  // dx/dq here, m/rad.
  THIMBLE_RT [[nodiscard]] Matrix3 jacobian() const noexcept;
  // The force at the grip that crank torques amount to. Zero where that is not defined.
  THIMBLE_RT [[nodiscard]] Triple force_of(const Triple& torque) const noexcept;
  // Kinetic, potential and what the stops have stored.
  THIMBLE_RT [[nodiscard]] double mechanical_energy_j() const noexcept;
  [[nodiscard]] std::uint64_t standstills() const noexcept { return standstills_; }
  [[nodiscard]] const DeltaLinkage& linkage() const noexcept { return linkage_; }

 private:
  // Steps between two sets of cranks that are computed from the angles: in between each follows
  // from the one before.
  static constexpr int kStepsToExactCranks = 20;

  struct Inputs {
    Triple motor_torque, grip_force;
  };
  struct Stage {
    Triple velocity, acceleration;  // of the grip, of the cranks
  };
  // `pose`: that of `q`.
  [[nodiscard]] Stage evaluate(const Triple& q, const Triple& rate, const DeltaLinkage::Pose& pose,
                               const Inputs& in) const noexcept;
  [[nodiscard]] DeltaLinkage::Cranks cranks_after(const Triple& way_rad) const noexcept;
  void stand_still() noexcept;
  [[nodiscard]] Triple crank_torques(const Triple& q, const Triple& sine,
                                     const Triple& rate) const noexcept;
  [[nodiscard]] Triple grip_forces(const Triple& x, const Triple& velocity) const noexcept;
  [[nodiscard]] Matrix3 mass_matrix(const Matrix3& jacobian) const noexcept;

  FalconParameters p_;
  DeltaLinkage linkage_;
  double crank_kg_m2_{};        // with the rotor and half of the rods
  double crank_moment_kg_m_{};  // first moment of crank and half of the rods
  double grip_kg_{};            // with half of all rods
  Triple lean_{};               // how far each crank's outward direction points up
  Triple q_{};
  Triple rate_{};
  std::optional<DeltaLinkage::Pose> pose_;  // for q_; nothing before it was put anywhere
  int steps_since_exact_{0};
  std::uint64_t standstills_{0};
};

}  // namespace thimble::sim
