#include "sim/model/arm/arm_on_board.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>

namespace thimble::sim {

ArmOnBoard::ArmOnBoard(const ArmParameters& parameters, ControllerBoard& board)
    : plant_(parameters),
      board_(&board),
      home_(plant_.dynamics().tip(ArmDynamics::pose(parameters.home_rad))) {}

void ArmOnBoard::park() noexcept {
  start_at({});
  is_started_ = false;
}

void ArmOnBoard::start_at(MonotonicTime t) noexcept {
  is_started_ = true;
  now_ = t;
  plant_time_ = t;
  board_->power_up(t, Duration{0}, encoder_totals());
  board_->run_until(t, encoder_totals());
}

EncoderTotals ArmOnBoard::encoder_totals() const noexcept {
  const ArmParameters& p = plant_.dynamics().parameters();
  EncoderTotals totals{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double motor_turns =
        p.motor_sign[i] * plant_.joint_rad()[i] * p.drive_ratio[i] / (2 * std::numbers::pi);
    totals[i] = static_cast<std::int64_t>(std::floor(motor_turns * p.counts_per_motor_turn[i]));
  }
  const std::array<double, 3> turned_rad = gimbal_rad();
  for (std::size_t i = 0; i < 3; ++i) {
    const double turns = turned_rad[i] / (2 * std::numbers::pi);
    totals[3 + i] = static_cast<std::int64_t>(std::floor(turns * p.gimbal_counts_per_turn[i]));
  }
  return totals;
}

// The first axis undoes what the waist turns, the second what the forearm does, the third is the
// roll. Ours: nobody says how the axes lie.
std::array<double, 3> ArmOnBoard::gimbal_rad() const noexcept {
  const ArmParameters& p = plant_.dynamics().parameters();
  if (p.gimbal_counts_per_turn == std::array<double, 3>{}) return {};
  const JointVector& q = plant_.joint_rad();
  return {stylus_rad_[0] - (q[0] - p.home_rad[0]), stylus_rad_[1] - (q[2] - p.home_rad[2]),
          stylus_rad_[2]};
}

JointVector ArmOnBoard::motor_torque() const noexcept {
  const ArmParameters& p = plant_.dynamics().parameters();
  const std::array<double, 3> current_a = board_->amplifier().current_a();
  JointVector torque{};
  for (std::size_t i = 0; i < 3; ++i) {
    torque[i] =
        p.motor_sign[i] * p.torque_constant_newton_m_per_a[i] * current_a[i] * p.drive_ratio[i];
  }
  return torque;
}

Force3 ArmOnBoard::force_of_load() noexcept {
  if (load_ == nullptr) return {};
  set_stylus_button(is_stylus_held_down_ || load_->is_button_pressed(plant_time_));
  const Force3 force =
      load_->force_on_tip(plant_time_, kSubstep, plant_.tip(), plant_.tip_velocity());
  if (is_finite(force)) return force;
  ++non_finite_forces_;
  return {};
}

// What the motors are told within a substep acts from its end on.
void ArmOnBoard::step() noexcept {
  const Force3 force = push_ + force_of_load();
  plant_.step(seconds(kSubstep), torque_, force);
  plant_time_ = plant_time_ + kSubstep;
  board_->run_until(plant_time_, encoder_totals());
  torque_ = motor_torque();
}

void ArmOnBoard::advance_arm(MonotonicTime t) noexcept {
  if (!is_started_) start_at(t);
  if (t < now_) return;
  if (plant_time_ == now_) torque_ = motor_torque();  // told at the very start of the substep
  while (plant_time_ + kSubstep <= t) step();
  now_ = t;
  // The encoders are then up to one substep old; exact when `t` is on the plant's grid.
  if (plant_time_ < t) board_->run_until(t, encoder_totals());
}

void ArmOnBoard::push_tip(Force3 force) noexcept {
  if (!is_finite(force)) {
    ++non_finite_forces_;
    force = {};
  }
  push_ = force;
}

bool ArmOnBoard::move_tip_to(Position3 tip) noexcept {
  const std::optional<JointVector> q = plant_.dynamics().inverse(tip);
  if (!q.has_value()) return false;
  plant_.rest_at(*q);
  return true;
}

void ArmOnBoard::press_calibration_button(bool pressed) noexcept {
  board_->set_calibration_button(pressed);
}

void ArmOnBoard::press_stylus_button(bool pressed) noexcept {
  is_stylus_held_down_ = pressed;
  set_stylus_button(pressed);
}

void ArmOnBoard::set_stylus_button(bool pressed) noexcept {
  if (pressed && !is_stylus_down_) ++stylus_presses_;
  is_stylus_down_ = pressed;
  board_->set_stylus_button(pressed);
}

void ArmOnBoard::turn_stylus(const std::array<double, 3>& angle_rad) noexcept {
  if (is_finite(angle_rad[0], angle_rad[1], angle_rad[2])) stylus_rad_ = angle_rad;
}

plugin::ArmTruth ArmOnBoard::truth() const noexcept {
  plugin::ArmTruth truth;
  truth.tip = plant_.tip();
  truth.tip_velocity = plant_.tip_velocity();
  truth.motor_force = plant_.dynamics().force_of(plant_.pose(), motor_torque());
  truth.motor_current_a = board_->amplifier().current_a();
  truth.gimbal_rad = gimbal_rad();
  truth.mechanical_energy_j = plant_.mechanical_energy_j();
  truth.is_amplifier_on = board_->amplifier().is_on();
  return truth;
}

}  // namespace thimble::sim
