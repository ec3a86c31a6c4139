#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "hal/plugin/sim_model.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::sim {

// A simulated Silicon Labs CP2112: eight lines behind feature reports (AN495, rev. 0.3).
//
// A line is an input until it is told otherwise. What hangs on a line is its wire: high while the
// contact to ground is open, for the chip pulls it up, else low. An output that pushes has its
// latch's level, an open-drain one that of its latch and its wire together.
//
// Thread, Ownership: as every SimHidModel.
class Cp2112Model final : public plugin::SimHidModel, public plugin::ModelPanel {
 public:
  static constexpr std::size_t kLines = 8;
  static constexpr std::uint16_t kVendorId = 0x10C4;   // AN495, table of USB customization data
  static constexpr std::uint16_t kProductId = 0xEA90;  // the same
  // Numbers of its feature reports, and their lengths with the number: AN495, sections 4 and 5.
  static constexpr std::uint8_t kGpioConfig = 0x02;
  static constexpr std::uint8_t kGetGpio = 0x03;
  static constexpr std::uint8_t kSetGpio = 0x04;
  static constexpr std::uint8_t kVersion = 0x05;
  static constexpr std::uint8_t kSmbusConfig = 0x06;
  static constexpr std::uint8_t kLockByte = 0x20;
  static constexpr std::size_t kSmbusConfigBytes = 14;
  static constexpr std::uint8_t kPartNumber = 0x0C;  // AN495, get version information

  [[nodiscard]] bus::BusDeviceInfo describe() const override;
  [[nodiscard]] Duration frame_period() const noexcept override;
  THIMBLE_RT void advance(MonotonicTime now) noexcept override { now_ = now; }
  // The SMBus's, which nobody asks for here.
  THIMBLE_RT void out_report(std::span<const std::uint8_t>) noexcept override {}
  THIMBLE_RT std::size_t in_report(std::span<std::uint8_t>) noexcept override { return 0; }
  [[nodiscard]] std::vector<std::uint8_t> report_descriptor() const override;
  std::size_t get_report(plugin::HidReportKind kind, std::uint8_t number,
                         std::span<std::uint8_t> out) noexcept override;
  bool set_report(plugin::HidReportKind kind,
                  std::span<const std::uint8_t> bytes) noexcept override;
  THIMBLE_RT void power_cycle() noexcept override;
  [[nodiscard]] plugin::ArmBackend* arm_backend() noexcept override { return nullptr; }
  [[nodiscard]] plugin::ModelPanel* panel() noexcept override { return this; }

  // Opens the contact between the line and ground, or closes it again.
  bool press(unsigned line, bool is_open) noexcept override;
  // "line_N": its level, 0 or 1. "changes_N": how often that changed since the model was made.
  // "told_s": when the host last read another level of an input than before, on the model's clock.
  [[nodiscard]] std::vector<Reading> readings() const override;

  [[nodiscard]] bool level(std::size_t line) const noexcept;
  [[nodiscard]] std::uint64_t changes(std::size_t line) const noexcept { return changes_.at(line); }

 private:
  struct Settings {
    std::uint8_t outputs{0};    // bit set: an output
    std::uint8_t push_pull{0};  // bit set: not open drain
    std::uint8_t special{0};    // kept, without effect
    std::uint8_t clock_divider{0};
    std::uint8_t latch{0xFF};
    std::array<std::uint8_t, kSmbusConfigBytes> smbus{
        kSmbusConfig, 0, 1, 0x86, 0xA0, 2, 0, 0, 0, 0, 0, 0, 0, 0};
  };
  [[nodiscard]] std::uint8_t levels() const noexcept;
  void note_told() noexcept;
  void count_changes(std::uint8_t before) noexcept;

  Settings settings_{};
  std::uint8_t wires_{0};  // bit set: the contact to ground is open
  std::array<std::uint64_t, kLines> changes_{};
  MonotonicTime now_{};
  std::uint8_t told_{0};  // of the inputs
  MonotonicTime told_at_{};
};

}  // namespace thimble::sim
