#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/geometry.hpp"
#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/bus/bus_enumerator.hpp"

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

// The truth inside a model, for tests and the lab; a driver never sees it.
struct ArmTruth {
  Position3 tip{};
  Velocity3 tip_velocity{};
  Force3 motor_force{};  // what the motors exert at the tip now
  std::array<double, 3> motor_current_a{};
  // Of the gimbal's axes, 0 with the arm in its home pose and the stylus straight; 0 without
  // gimbal.
  std::array<double, 3> gimbal_rad{};
  double mechanical_energy_j{0};  // kinetic + potential
  bool is_amplifier_on{false};
};

// Backend face of every simulated arm: physical verbs.
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
  [[nodiscard]] virtual ArmTruth truth() const noexcept = 0;
};

// Bus face of a simulated HID device: what its firmware and USB interface do.
// The bus calls, in virtual time and from one thread, once per frame: advance(t), then
// out_report() if the host had one queued before the frame began, then in_report().
class SimHidModel {
 public:
  virtual ~SimHidModel() = default;
  [[nodiscard]] virtual bus::BusDeviceInfo describe() const = 0;
  [[nodiscard]] virtual Duration frame_period() const noexcept = 0;  // 1 ms at full speed
  // Brings mechanics and firmware to `t` (never backwards).
  virtual void advance(MonotonicTime t) noexcept = 0;
  virtual void out_report(std::span<const std::uint8_t> bytes) noexcept = 0;
  // Fills `out` (at most kMaxHidReportBytes) and returns its length; 0: the device NAKs.
  virtual std::size_t in_report(std::span<std::uint8_t> out) noexcept = 0;
  // Power cut and restored, as on unplug and replug: counters and state are lost.
  virtual void power_cycle() noexcept = 0;
  [[nodiscard]] virtual ArmBackend* arm_backend() noexcept = 0;  // nullptr: not an arm
};

struct SimModelSettings {
  double amplifier_max_a{0};  // full scale the firmware was built with
  std::uint64_t seed{0};
};

// How a model registers, as a driver does: "sim:NAME" makes one.
struct SimModelEntry {
  std::string name;
  std::string description;
  std::function<Result<std::unique_ptr<SimHidModel>>(const SimModelSettings&)> create_hid;
};

class SimModelRegistry {
 public:
  void add(SimModelEntry entry) { entries_.push_back(std::move(entry)); }
  [[nodiscard]] const std::vector<SimModelEntry>& entries() const noexcept { return entries_; }
  [[nodiscard]] const SimModelEntry* find(std::string_view name) const noexcept {
    for (const SimModelEntry& entry : entries_) {
      if (entry.name == name) return &entry;
    }
    return nullptr;
  }

 private:
  std::vector<SimModelEntry> entries_;
};

}  // namespace thimble::plugin
