#pragma once

#include <array>

#include "hal/base/geometry.hpp"
#include "hal/base/time.hpp"

namespace thimble::plugin {

// A simulated person (or test rig) that holds the tip of a simulated arm. The arm's model
// asks it once per plant step, so that it really feels the force of the motors.
// Thread: that of the bus, in virtual time. RT. Ownership: of whoever made it; it outlives the
// arm's hold on it, which ends with hold_tip(nullptr).
class TipLoad {
 public:
  virtual ~TipLoad() = default;
  // Force that the load exerts on the tip, N, base frame, at plant time `t`; advances the
  // load's own state by `dt`. No allocation.
  virtual Force3 force_on_tip(MonotonicTime t, Duration dt, Position3 tip,
                              Velocity3 velocity) noexcept = 0;
  // Level of the stylus button at `t`.
  [[nodiscard]] virtual bool is_button_pressed(MonotonicTime t) const noexcept = 0;
};

// The truth inside a model, for tests and the lab; a driver never sees it. Base frame, SI units.
struct ArmTruth {
  Position3 tip{};
  Velocity3 tip_velocity{};
  Force3 motor_force{};                     // what the motors exert at the tip now
  std::array<double, 3> motor_current_a{};  // 0 where the model has no currents, as a Falcon's
  // Of the gimbal's axes, 0 with the arm in its home pose and the stylus straight; 0 without
  // gimbal.
  std::array<double, 3> gimbal_rad{};
  double mechanical_energy_j{0};  // kinetic + potential
  bool is_amplifier_on{false};
};

// Backend face of every simulated arm: physical verbs. Places and forces are in the base frame, m
// and N.
// Thread: that of the bus, or another while the bus stands still. RT, but home_position().
// Ownership: a face of the arm's model; valid as long as that is.
class ArmBackend {
 public:
  virtual ~ArmBackend() = default;
  virtual void hold_tip(TipLoad* load) noexcept = 0;     // nullptr: nobody holds it
  virtual void push_tip(Force3 force) noexcept = 0;      // constant extra force, N
  virtual bool move_tip_to(Position3 tip) noexcept = 0;  // at rest; false: out of reach
  virtual void press_calibration_button(bool pressed) noexcept = 0;
  virtual void press_stylus_button(bool pressed) noexcept = 0;
  // How the person holds the stylus from now on: yaw, pitch and roll in rad. It keeps that
  // direction while the arm moves under it, so the gimbal turns.
  virtual void turn_stylus(const std::array<double, 3>& angle_rad) noexcept = 0;
  // The pose in which the arm must be held while the calibration button is pressed.
  [[nodiscard]] virtual Position3 home_position() const noexcept = 0;
  // Where it must be brought first, when it learns its reference on the way from there to the home
  // pose.
  [[nodiscard]] virtual Position3 calibration_start() const noexcept { return home_position(); }
  [[nodiscard]] virtual ArmTruth truth() const noexcept = 0;
};

}  // namespace thimble::plugin
