#pragma once

#include <string>

#include "hal/plugin/sim_model.hpp"
#include "hal/plugin/sim_serial_model.hpp"
#include "hal/rt/annotations.hpp"
#include "sim/model/arm/arm_on_board.hpp"
#include "sim/model/arm/board_first.hpp"
#include "sim/model/arm/text_firmware.hpp"

namespace thimble::sim {

// A simulated arm of the WoodenHaptics family behind a Teensy that speaks text over USB serial.
//
// Thread, RT, Ownership: as SimSerialModel and ArmOnBoard.
class TextArmModel final : public plugin::SimSerialModel,
                           private BoardFirst<TextFirmware>,
                           public ArmOnBoard {
 public:
  // Fact, woody_teensy_mini.ino: 0.4 s, and what the USB needs; ours, to a round figure.
  static constexpr Duration kBoot{500'000'000};

  TextArmModel(const ArmParameters& parameters, const TextFirmware::Settings& settings);

  [[nodiscard]] bus::BusDeviceInfo describe() const override;
  [[nodiscard]] std::uint32_t bit_per_s() const noexcept override { return 0; }
  THIMBLE_RT void advance(MonotonicTime t) noexcept override { advance_arm(t); }
  THIMBLE_RT std::size_t take(std::span<const std::uint8_t> bytes) noexcept override;
  THIMBLE_RT std::size_t give(std::span<std::uint8_t> out) noexcept override;
  [[nodiscard]] MonotonicTime unchanged_until() const noexcept override;
  THIMBLE_RT void power_cycle() noexcept override;
  [[nodiscard]] plugin::ArmBackend* arm_backend() noexcept override { return this; }
  [[nodiscard]] const TextFirmware& firmware() const noexcept { return firmware_; }
};

// Adds "sim:NAME-serial" for every arm that has a firmware with the text protocol.
// SimModelSettings: amplifier_max_a 0 means the 6 A of the source; a negative, non-finite or >
// 32.767 A value is InvalidArgument. An odd seed gives a build that wants its button pressed first;
// the seed also sets the phase of the board's PWM. Thread: control thread. Not RT.
void register_text_arm_models(plugin::SimModelRegistry& registry);

}  // namespace thimble::sim
