#include "sim/model/arm/phantom_arm_model.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>

#include "drivers/phantom/phantom_wire.hpp"

namespace thimble::sim {
namespace {

namespace wire = phantom::wire;

ControllerFirmware::Settings firmware_settings(const ArmParameters& parameters,
                                               const plugin::SimModelSettings& settings) {
  // The board's PWM runs freely against the host's frames: any phase is as good as another.
  const std::uint64_t substeps_per_period =
      static_cast<std::uint64_t>(kPwmPeriod / PhantomArmModel::kSubstep);
  const auto phase = static_cast<std::int64_t>(settings.seed % substeps_per_period);
  return {.amplifier_max_a = settings.amplifier_max_a,
          .frame_period = wire::kSamplePeriod,
          .pwm_phase = phase * PhantomArmModel::kSubstep,
          .is_teensy = parameters.is_teensy_board};
}

}  // namespace

PhantomArmModel::PhantomArmModel(const ArmParameters& parameters,
                                 const plugin::SimModelSettings& settings)
    : plant_(parameters),
      firmware_(firmware_settings(parameters, settings)),
      home_(plant_.dynamics().tip(ArmDynamics::pose(parameters.home_rad))) {
  start_at({});
  is_started_ = false;
}

bus::BusDeviceInfo PhantomArmModel::describe() const {
  const std::string name(plant_.dynamics().parameters().name);
  bus::BusDeviceInfo info;
  info.address = {"sim:" + name};
  info.kind = bus::BusKind::Hid;
  const bool is_teensy = plant_.dynamics().parameters().is_teensy_board;
  info.vendor_id = is_teensy ? wire::kTeensyVendorId : wire::kMbedVendorId;
  info.product_id = is_teensy ? wire::kTeensyProductId : wire::kMbedProductId;
  // Ours: no source tells the strings of a real board; a simulated one says what it is.
  info.manufacturer = "Thimble";
  info.product = "Simulated arm " + name;
  info.serial_number = "SIM-" + name;
  info.input_report_bytes = firmware_.report_bytes();
  info.output_report_bytes = firmware_.report_bytes();
  return info;
}

Duration PhantomArmModel::frame_period() const noexcept { return wire::kSamplePeriod; }

void PhantomArmModel::start_at(MonotonicTime t) noexcept {
  is_started_ = true;
  now_ = t;
  plant_time_ = t;
  firmware_.power_up(t, Duration{0}, encoder_totals());
  firmware_.run_until(t, encoder_totals());
}

EncoderTotals PhantomArmModel::encoder_totals() const noexcept {
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
std::array<double, 3> PhantomArmModel::gimbal_rad() const noexcept {
  const ArmParameters& p = plant_.dynamics().parameters();
  if (p.gimbal_counts_per_turn == std::array<double, 3>{}) return {};
  const JointVector& q = plant_.joint_rad();
  return {stylus_rad_[0] - (q[0] - p.home_rad[0]), stylus_rad_[1] - (q[2] - p.home_rad[2]),
          stylus_rad_[2]};
}

JointVector PhantomArmModel::motor_torque() const noexcept {
  const ArmParameters& p = plant_.dynamics().parameters();
  const std::array<double, 3> current_a = firmware_.amplifier().current_a();
  JointVector torque{};
  for (std::size_t i = 0; i < 3; ++i) {
    torque[i] =
        p.motor_sign[i] * p.torque_constant_newton_m_per_a[i] * current_a[i] * p.drive_ratio[i];
  }
  return torque;
}

Force3 PhantomArmModel::force_of_load() noexcept {
  if (load_ == nullptr) return {};
  set_stylus_button(is_stylus_held_down_ || load_->is_button_pressed(plant_time_));
  const Force3 force =
      load_->force_on_tip(plant_time_, kSubstep, plant_.tip(), plant_.tip_velocity());
  if (is_finite(force)) return force;
  ++non_finite_forces_;
  return {};
}

void PhantomArmModel::step() noexcept {
  const Force3 force = push_ + force_of_load();
  plant_.step(seconds(kSubstep), motor_torque(), force);
  plant_time_ = plant_time_ + kSubstep;
  firmware_.run_until(plant_time_, encoder_totals());
}

void PhantomArmModel::advance(MonotonicTime t) noexcept {
  if (!is_started_) start_at(t);
  if (t < now_) return;
  while (plant_time_ + kSubstep <= t) step();
  now_ = t;
  // The encoders are then up to one substep old; exact when `t` is on the plant's grid.
  if (plant_time_ < t) firmware_.run_until(t, encoder_totals());
}

void PhantomArmModel::out_report(std::span<const std::uint8_t> bytes) noexcept {
  firmware_.out_report(now_, bytes);
}

std::size_t PhantomArmModel::in_report(std::span<std::uint8_t> out) noexcept {
  return firmware_.in_report(now_, out);
}

void PhantomArmModel::power_cycle() noexcept { firmware_.power_up(now_, kBoot, encoder_totals()); }

void PhantomArmModel::push_tip(Force3 force) noexcept {
  if (!is_finite(force)) {
    ++non_finite_forces_;
    force = {};
  }
  push_ = force;
}

bool PhantomArmModel::move_tip_to(Position3 tip) noexcept {
  const std::optional<JointVector> q = plant_.dynamics().inverse(tip);
  if (!q.has_value()) return false;
  plant_.rest_at(*q);
  return true;
}

void PhantomArmModel::press_calibration_button(bool pressed) noexcept {
  firmware_.set_calibration_button(pressed);
}

void PhantomArmModel::press_stylus_button(bool pressed) noexcept {
  is_stylus_held_down_ = pressed;
  set_stylus_button(pressed);
}

void PhantomArmModel::set_stylus_button(bool pressed) noexcept {
  if (pressed && !is_stylus_down_) ++stylus_presses_;
  is_stylus_down_ = pressed;
  firmware_.set_stylus_button(pressed);
}

void PhantomArmModel::turn_stylus(const std::array<double, 3>& angle_rad) noexcept {
  if (is_finite(angle_rad[0], angle_rad[1], angle_rad[2])) stylus_rad_ = angle_rad;
}

plugin::ArmTruth PhantomArmModel::truth() const noexcept {
  plugin::ArmTruth truth;
  truth.tip = plant_.tip();
  truth.tip_velocity = plant_.tip_velocity();
  truth.motor_force = plant_.dynamics().force_of(plant_.pose(), motor_torque());
  truth.motor_current_a = firmware_.amplifier().current_a();
  truth.gimbal_rad = gimbal_rad();
  truth.mechanical_energy_j = plant_.mechanical_energy_j();
  truth.is_amplifier_on = firmware_.amplifier().is_on();
  return truth;
}

PhantomArmModel::Counters PhantomArmModel::counters() const noexcept {
  return {firmware_.counters(), stylus_presses_, non_finite_forces_};
}

}  // namespace thimble::sim
