#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "hal/plugin/sim_model.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::sim {

// What tells one simulated puck from another.
struct PuckParameters {
  std::string_view name;  // of the product
  std::uint16_t vendor_id{};
  std::uint16_t product_id{};
  bool is_combined{false};     // all six axes in one report, or translation and rotation in turn
  std::int16_t full_scale{};   // counts of an axis at its stop
  std::size_t button_bytes{};  // of the button report, without its number
};

// A simulated 3Dconnexion puck: a cap on springs behind a USB HID interface of full speed.
//
// The cap has no mass that a hand would feel: springs and rubber only, so it follows the force on
// it with a time constant of kDamping / kSpring. It says where it is while it is out of its centre,
// then zero three times, then nothing; a change of the buttons at once, before any axes.
//
// Thread, RT, Ownership: as PhantomArmModel.
class PuckModel final : public plugin::SimHidModel, public plugin::ArmBackend {
 public:
  // All ours: a cap gives way by a millimetre or two under some newtons.
  static constexpr double kTravel_m = 0.0015;
  static constexpr double kTilt_rad = 0.25;
  static constexpr double kSpring_newton_per_m = 2000;
  static constexpr double kDamping_newton_s_per_m = 20;
  static constexpr Duration kSubstep{1'000'000};

  explicit PuckModel(const PuckParameters& parameters) : parameters_(parameters) {}

  [[nodiscard]] bus::BusDeviceInfo describe() const override;
  [[nodiscard]] std::vector<std::uint8_t> report_descriptor() const override;
  [[nodiscard]] Duration frame_period() const noexcept override;
  THIMBLE_RT void advance(MonotonicTime t) noexcept override;
  // Its light, which shows nothing here.
  THIMBLE_RT void out_report(std::span<const std::uint8_t> bytes) noexcept override;
  THIMBLE_RT std::size_t in_report(std::span<std::uint8_t> out) noexcept override;
  THIMBLE_RT void power_cycle() noexcept override;
  [[nodiscard]] plugin::ArmBackend* arm_backend() noexcept override { return this; }

  THIMBLE_RT void hold_tip(plugin::TipLoad* load) noexcept override { load_ = load; }
  // Not finite: no force.
  THIMBLE_RT void push_tip(Force3 force) noexcept override;
  // The tip is the cap; it springs back when nothing holds it. False beyond its travel.
  THIMBLE_RT bool move_tip_to(Position3 tip) noexcept override;
  THIMBLE_RT void press_calibration_button(bool) noexcept override {}  // it has none
  THIMBLE_RT void press_stylus_button(bool pressed) noexcept override { is_pressed_ = pressed; }
  // Turns of the cap about its x, y and z.
  THIMBLE_RT void turn_stylus(const std::array<double, 3>& angle_rad) noexcept override;
  [[nodiscard]] Position3 home_position() const noexcept override { return {}; }
  THIMBLE_RT [[nodiscard]] plugin::ArmTruth truth() const noexcept override;

 private:
  void step() noexcept;
  [[nodiscard]] std::int16_t counts(double share) const noexcept;
  [[nodiscard]] std::array<std::int16_t, 6> axes() const noexcept;
  std::size_t say_buttons(std::span<std::uint8_t> out) noexcept;

  PuckParameters parameters_;
  plugin::TipLoad* load_{nullptr};
  Force3 push_{};
  Displacement3 cap_{};  // from its centre, base frame
  Velocity3 velocity_{};
  std::array<double, 3> tilt_rad_{};
  bool is_started_{false};
  MonotonicTime time_{};
  bool is_pressed_{false};       // the left button, by a verb
  bool is_held_pressed_{false};  // by the load
  bool has_said_pressed_{false};
  bool is_rotation_next_{false};  // separate layout
  int zeros_left_{0};
};

[[nodiscard]] PuckParameters combined_puck();
[[nodiscard]] PuckParameters separate_puck();

}  // namespace thimble::sim
