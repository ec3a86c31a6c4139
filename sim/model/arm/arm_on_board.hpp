#pragma once

#include <array>
#include <cstdint>

#include "hal/plugin/arm_backend.hpp"
#include "hal/rt/annotations.hpp"
#include "sim/model/arm/arm_plant.hpp"
#include "sim/model/arm/controller_board.hpp"

namespace thimble::sim {

// The mechanics of a simulated arm, its encoders and motors, and the person's hand, on whatever
// controller board: what the arms of every protocol have in common.
//
// The first advance_arm() sets the plant's clock; until then the arm rests, switched on long ago,
// its counters zero where it was parked. The mechanics go by substeps since then, and are the same
// whenever else it is called.
//
// Thread: one, that of the bus; the backend's verbs belong to the same thread and may be called
//   from a TipLoad while it is asked.
// RT: everything after construction: no allocation, work in proportion to the time that
//   advance_arm() covers.
// Ownership: a TipLoad must outlive its hold. The board belongs to who derives.
class ArmOnBoard : public plugin::ArmBackend {
 public:
  // Ours: a substep of the plant. Frame, PWM period and watchdog are whole multiples of it.
  static constexpr Duration kSubstep{100'000};

  THIMBLE_RT void hold_tip(plugin::TipLoad* load) noexcept override { load_ = load; }
  THIMBLE_RT void push_tip(Force3 force) noexcept override;
  THIMBLE_RT bool move_tip_to(Position3 tip) noexcept override;
  THIMBLE_RT void press_calibration_button(bool pressed) noexcept override;
  THIMBLE_RT void press_stylus_button(bool pressed) noexcept override;
  // Not finite: the stylus stays as it is.
  THIMBLE_RT void turn_stylus(const std::array<double, 3>& angle_rad) noexcept override;
  [[nodiscard]] Position3 home_position() const noexcept override { return home_; }
  THIMBLE_RT [[nodiscard]] plugin::ArmTruth truth() const noexcept override;

  [[nodiscard]] const ArmPlant& plant() const noexcept { return plant_; }
  [[nodiscard]] std::uint64_t stylus_presses() const noexcept { return stylus_presses_; }
  // Of push_tip() or a load: taken as zero.
  [[nodiscard]] std::uint64_t non_finite_forces() const noexcept { return non_finite_forces_; }

 protected:
  // `board` is used from park() on.
  ArmOnBoard(const ArmParameters& parameters, ControllerBoard& board);
  // Switched on long ago; once, when the board is there.
  void park() noexcept;
  THIMBLE_RT void advance_arm(MonotonicTime t) noexcept;
  [[nodiscard]] MonotonicTime now() const noexcept { return now_; }
  [[nodiscard]] EncoderTotals encoder_totals() const noexcept;

 private:
  [[nodiscard]] std::array<double, 3> gimbal_rad() const noexcept;
  [[nodiscard]] JointVector motor_torque() const noexcept;
  [[nodiscard]] Force3 force_of_load() noexcept;
  void start_at(MonotonicTime t) noexcept;
  void step() noexcept;
  void set_stylus_button(bool pressed) noexcept;

  ArmPlant plant_;
  ControllerBoard* board_;
  Position3 home_{};
  plugin::TipLoad* load_{nullptr};
  Force3 push_{};
  JointVector torque_{};  // of the motors in the substep that has begun
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
