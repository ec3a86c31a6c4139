#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "hal/plugin/sim_model.hpp"
#include "sim/fault/short_reports.hpp"

namespace thimble::campaign {

// What reached an arm over its wire, read from the bytes by nobody but this.
struct WireSeen {
  std::uint64_t reports{0};  // of the board's length: it takes no notice of others
  std::uint64_t cut{0};      // short ones, without effect
  MonotonicTime last_report{Duration::min() / 2};
  MonotonicTime last_nonzero{Duration::min() / 2};  // the last report that asked for a current
  std::array<double, 3> largest_a{};                // of each motor since look()
};

// A simulated arm with a tap at its plug: what the firmware is handed is written down first. The
// plug may cut it short.
//
// Thread: as SimHidModel.
class TappedArm final : public plugin::SimHidModel, public plugin::ArmBackend {
 public:
  explicit TappedArm(std::unique_ptr<plugin::SimHidModel> arm);

  void set_cable(const sim::FaultPlan& plan) { plug_.set_plan(plan); }

  // What was seen so far; the largest currents begin anew.
  [[nodiscard]] WireSeen look() noexcept;

  [[nodiscard]] bus::BusDeviceInfo describe() const override { return arm_->describe(); }
  [[nodiscard]] Duration frame_period() const noexcept override { return arm_->frame_period(); }
  void advance(MonotonicTime t) noexcept override {
    now_ = t;
    arm_->advance(t);
  }
  void out_report(std::span<const std::uint8_t> bytes) noexcept override;
  std::size_t in_report(std::span<std::uint8_t> out) noexcept override {
    return arm_->in_report(out);
  }
  void power_cycle() noexcept override { arm_->power_cycle(); }
  [[nodiscard]] plugin::ArmBackend* arm_backend() noexcept override { return this; }

  void hold_tip(plugin::TipLoad* load) noexcept override { backend_->hold_tip(load); }
  void push_tip(Force3 force) noexcept override { backend_->push_tip(force); }
  bool move_tip_to(Position3 tip) noexcept override { return backend_->move_tip_to(tip); }
  void press_calibration_button(bool pressed) noexcept override {
    backend_->press_calibration_button(pressed);
  }
  void press_stylus_button(bool pressed) noexcept override {
    backend_->press_stylus_button(pressed);
  }
  void turn_stylus(const std::array<double, 3>& angle_rad) noexcept override {
    backend_->turn_stylus(angle_rad);
  }
  [[nodiscard]] Position3 home_position() const noexcept override {
    return backend_->home_position();
  }
  [[nodiscard]] plugin::ArmTruth truth() const noexcept override { return backend_->truth(); }

 private:
  std::unique_ptr<plugin::SimHidModel> arm_;
  plugin::ArmBackend* backend_;
  std::size_t report_bytes_;
  sim::ShortReports plug_;
  MonotonicTime now_{};
  WireSeen seen_{};
};

// The arms of sim/model/arm, each with a tap, and the Falcons, without one.
[[nodiscard]] std::vector<plugin::SimModelEntry> tapped_arms();

}  // namespace thimble::campaign
