#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "hal/plugin/sim_model.hpp"
#include "hal/rt/annotations.hpp"
#include "sim/model/arm/arm_plant.hpp"
#include "sim/model/arm/controller_firmware.hpp"

namespace thimble::sim {

// A simulated arm of the WoodenHaptics family: mechanics, encoders, motors and controller
// board behind a USB HID interface of full speed.
//
// The first advance() sets the plant's clock; until then the arm rests, switched on long ago,
// its counters zero where it was parked.
//
// Thread: one, that of the bus; the backend's verbs belong to the same thread and may be called
//   from a TipLoad while it is asked.
// RT: everything after construction but describe(): no allocation, work in proportion to the time
//   that advance() covers.
// Ownership: a TipLoad must outlive its hold.
class PhantomArmModel final : public plugin::SimHidModel, public plugin::ArmBackend {
 public:
  // Ours: a substep of the plant. Frame, PWM period and watchdog are whole multiples of it.
  static constexpr Duration kSubstep{100'000};
  // Fact, haptikfabrikenapi firmware/main.cpp: LEDs on for 0.5 s, off for 0.5 s, then encoders.
  static constexpr Duration kBoot{1'000'000'000};

  // `settings.amplifier_max_a` > 0.
  PhantomArmModel(const ArmParameters& parameters, const plugin::SimModelSettings& settings);

  [[nodiscard]] bus::BusDeviceInfo describe() const override;
  [[nodiscard]] Duration frame_period() const noexcept override;
  THIMBLE_RT void advance(MonotonicTime t) noexcept override;
  THIMBLE_RT void out_report(std::span<const std::uint8_t> bytes) noexcept override;
  THIMBLE_RT std::size_t in_report(std::span<std::uint8_t> out) noexcept override;
  THIMBLE_RT void power_cycle() noexcept override;
  [[nodiscard]] plugin::ArmBackend* arm_backend() noexcept override { return this; }

  THIMBLE_RT void hold_tip(plugin::TipLoad* load) noexcept override { load_ = load; }
  THIMBLE_RT void push_tip(Force3 force) noexcept override;
  THIMBLE_RT bool move_tip_to(Position3 tip) noexcept override;
  THIMBLE_RT void press_calibration_button(bool pressed) noexcept override;
  THIMBLE_RT void press_stylus_button(bool pressed) noexcept override;
  // Not finite: the stylus stays as it is.
  THIMBLE_RT void turn_stylus(const std::array<double, 3>& angle_rad) noexcept override;
  [[nodiscard]] Position3 home_position() const noexcept override { return home_; }
  THIMBLE_RT [[nodiscard]] plugin::ArmTruth truth() const noexcept override;

  // What happened that a driver cannot see.
  struct Counters {
    FirmwareCounters firmware{};
    std::uint64_t stylus_presses{0};     // only the 64-byte firmware reports the button
    std::uint64_t non_finite_forces{0};  // of push_tip() or a load: taken as zero
    bool operator==(const Counters&) const = default;
  };
  [[nodiscard]] Counters counters() const noexcept;
  [[nodiscard]] const ArmPlant& plant() const noexcept { return plant_; }

 private:
  [[nodiscard]] EncoderTotals encoder_totals() const noexcept;
  [[nodiscard]] std::array<double, 3> gimbal_rad() const noexcept;
  [[nodiscard]] JointVector motor_torque() const noexcept;
  [[nodiscard]] Force3 force_of_load() noexcept;
  void start_at(MonotonicTime t) noexcept;
  void step() noexcept;
  void set_stylus_button(bool pressed) noexcept;

  ArmPlant plant_;
  ControllerFirmware firmware_;
  Position3 home_{};
  plugin::TipLoad* load_{nullptr};
  Force3 push_{};
  bool is_started_{false};
  std::array<double, 3> stylus_rad_{};
  bool is_stylus_down_{false};
  bool is_stylus_held_down_{false};  // by press_stylus_button()
  MonotonicTime now_{};              // of the bus
  MonotonicTime plant_time_{};       // <= now_, less than a substep behind
  std::uint64_t stylus_presses_{0};
  std::uint64_t non_finite_forces_{0};
};

}  // namespace thimble::sim
