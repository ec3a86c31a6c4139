#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "hal/plugin/sim_model.hpp"
#include "hal/rt/annotations.hpp"
#include "sim/model/falcon/delta_plant.hpp"
#include "sim/model/falcon/falcon_processor.hpp"
#include "sim/model/falcon/ftdi_bridge.hpp"

namespace thimble::sim {

// The buttons of the ball grip, in the order of their bits.
enum class FalconButton : std::uint8_t { Right, Forward, Centre, Left };

// A simulated Novint Falcon: mechanics, encoders and motors, the processor that drives them, and
// the bridge chip between it and full-speed USB.
//
// The first advance() sets the plant's clock; until then the arm rests, switched on long ago, with
// nothing in its memory.
//
// Frame of everything handed out: Thimble's base frame, x right, y up, z to the person, origin as
// in the models table.
//
// Thread: one, that of the bus; the backend's verbs belong to the same thread and may be called
//   from a TipLoad while it is asked.
// RT: everything after construction but describe() and readings(): no allocation, work in
// proportion to the time
//   that advance() covers.
// Ownership: a TipLoad must outlive its hold.
class FalconArmModel final : public plugin::SimUsbModel,
                             public plugin::ArmBackend,
                             public plugin::ModelPanel {
 public:
  // Ours: a substep of the plant, the most that a hand's contact allows.
  static constexpr Duration kSubstep{100'000};

  explicit FalconArmModel(const FalconParameters& parameters);

  [[nodiscard]] bus::BusDeviceInfo describe() const override;
  THIMBLE_RT void advance(MonotonicTime t) noexcept override;
  THIMBLE_RT plugin::UsbAnswer control(const bus::UsbControlRequest& request,
                                       std::span<std::uint8_t> in) noexcept override;
  THIMBLE_RT plugin::UsbHandshake out_packet(std::uint8_t endpoint,
                                             std::span<const std::uint8_t> bytes) noexcept override;
  THIMBLE_RT plugin::UsbAnswer in_packet(std::uint8_t endpoint,
                                         std::span<std::uint8_t> out) noexcept override;
  // While what is on the lines may fill a packet before its time, each round matters.
  THIMBLE_RT [[nodiscard]] MonotonicTime unchanged_until() const noexcept override;
  THIMBLE_RT void power_cycle() noexcept override;
  [[nodiscard]] plugin::ArmBackend* arm_backend() noexcept override { return this; }

  THIMBLE_RT void hold_tip(plugin::TipLoad* load) noexcept override { load_ = load; }
  THIMBLE_RT void push_tip(Force3 force) noexcept override;
  THIMBLE_RT bool move_tip_to(Position3 tip) noexcept override;
  THIMBLE_RT void press_calibration_button(bool) noexcept override {}  // it has none
  // The one in the middle of the grip.
  THIMBLE_RT void press_stylus_button(bool pressed) noexcept override;
  THIMBLE_RT void turn_stylus(const std::array<double, 3>&) noexcept override {}  // a ball
  [[nodiscard]] Position3 home_position() const noexcept override;
  [[nodiscard]] Position3 calibration_start() const noexcept override;
  // Currents are zero: nobody knows what the motors draw; the force is truth.
  THIMBLE_RT [[nodiscard]] plugin::ArmTruth truth() const noexcept override;

  // Nothing to press: the buttons of the grip are the arm's. To read: "uploads", how often somebody
  // began to send it an image since the model was made, through every loss of power.
  [[nodiscard]] plugin::ModelPanel* panel() noexcept override { return this; }
  bool press(unsigned /*number*/, bool /*pressed*/) noexcept override { return false; }
  [[nodiscard]] std::vector<Reading> readings() const override;
  // "lost-echo" N: the Nth byte of the next image, or of one after it that is so long, is not
  // echoed. "deaf" N: so many questions of the boot-loader's are not answered. "short-replies" N,
  // "glued-replies" N: as FalconReplyFaults. "latency" MS: of the bridge, whatever it is told, up
  // to 255.
  THIMBLE_RT bool set_fault(std::string_view name, std::uint32_t number) noexcept override;
  [[nodiscard]] std::vector<Fault> faults() const override;

  THIMBLE_RT void press_button(FalconButton button, bool pressed) noexcept;
  // As if an image had been uploaded, at any time.
  THIMBLE_RT void load_firmware() noexcept { processor_.start_firmware(); }
  void set_faults(const FalconBootFaults& boot, const FalconReplyFaults& replies) noexcept;

  [[nodiscard]] const FtdiBridge& bridge() const noexcept { return bridge_; }
  [[nodiscard]] const FalconProcessor& processor() const noexcept { return processor_; }
  [[nodiscard]] const DeltaPlant& plant() const noexcept { return plant_; }
  [[nodiscard]] std::uint64_t non_finite_forces() const noexcept { return non_finite_forces_; }

 private:
  [[nodiscard]] Triple to_device(Position3 tip) const noexcept;
  [[nodiscard]] Position3 to_base(const Triple& x) const noexcept;
  [[nodiscard]] CrankCounts crank_counts() const noexcept;
  [[nodiscard]] Triple motor_torque() const noexcept;
  [[nodiscard]] Force3 force_of_load() noexcept;
  void step() noexcept;
  void run_lines_until(MonotonicTime t) noexcept;
  void set_button(unsigned bit, bool pressed) noexcept;

  FalconParameters p_;
  DeltaPlant plant_;
  double newton_m_per_count_{};  // of a crank
  FtdiBridge bridge_;
  FalconProcessor processor_;
  CrankCounts counts_{};  // at plant_time_
  plugin::TipLoad* load_{nullptr};
  Force3 push_{};
  Triple torque_{};  // of the motors in the substep that has begun
  unsigned buttons_{0};
  bool is_centre_held_{false};  // by press_stylus_button(), beside what the load does
  bool is_started_{false};
  MonotonicTime now_{};         // of the bus
  MonotonicTime plant_time_{};  // <= now_, less than a substep behind
  std::uint64_t non_finite_forces_{0};
};

}  // namespace thimble::sim
