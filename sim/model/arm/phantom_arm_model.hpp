#pragma once

#include <cstdint>
#include <string>

#include "hal/plugin/sim_model.hpp"
#include "hal/rt/annotations.hpp"
#include "sim/model/arm/arm_on_board.hpp"
#include "sim/model/arm/board_first.hpp"
#include "sim/model/arm/controller_firmware.hpp"

namespace thimble::sim {

// A simulated arm of the WoodenHaptics family: mechanics, encoders, motors and controller
// board behind a USB HID interface of full speed.
//
// Thread, RT, Ownership: as SimHidModel and ArmOnBoard.
class PhantomArmModel final : public plugin::SimHidModel,
                              private BoardFirst<ControllerFirmware>,
                              public ArmOnBoard {
 public:
  // Fact, haptikfabrikenapi firmware/main.cpp: LEDs on for 0.5 s, off for 0.5 s, then encoders.
  static constexpr Duration kBoot{1'000'000'000};

  // `settings.amplifier_max_a` > 0.
  PhantomArmModel(const ArmParameters& parameters, const plugin::SimModelSettings& settings);

  [[nodiscard]] bus::BusDeviceInfo describe() const override;
  [[nodiscard]] Duration frame_period() const noexcept override;
  THIMBLE_RT void advance(MonotonicTime t) noexcept override { advance_arm(t); }
  THIMBLE_RT void out_report(std::span<const std::uint8_t> bytes) noexcept override;
  THIMBLE_RT std::size_t in_report(std::span<std::uint8_t> out) noexcept override;
  THIMBLE_RT void power_cycle() noexcept override;
  [[nodiscard]] plugin::ArmBackend* arm_backend() noexcept override { return this; }

  // What happened that a driver cannot see.
  struct Counters {
    FirmwareCounters firmware{};
    std::uint64_t stylus_presses{0};     // only the 64-byte firmware reports the button
    std::uint64_t non_finite_forces{0};  // of push_tip() or a load: taken as zero
    bool operator==(const Counters&) const = default;
  };
  [[nodiscard]] Counters counters() const noexcept;
};

}  // namespace thimble::sim
