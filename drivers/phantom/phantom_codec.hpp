#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/phantom/phantom_wire.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::phantom {

// Which firmware family the controller runs; its report length tells.
enum class ReportForm : std::uint8_t { Mbed, Teensy };

[[nodiscard]] constexpr std::size_t report_bytes(ReportForm form) noexcept {
  return form == ReportForm::Mbed ? wire::kMbedReportBytes : wire::kTeensyReportBytes;
}

// The form whose reports have this length in both directions, if there is one.
[[nodiscard]] std::optional<ReportForm> form_of(std::size_t input_bytes,
                                                std::size_t output_bytes) noexcept;

// What the controller says once per exchange. Raw 16-bit counters: they wrap.
struct DeviceReport {
  std::array<std::int16_t, 3> base_counts{};    // a, b, c
  std::array<std::int16_t, 3> gimbal_counts{};  // d, e, f, the stylus button taken out of d
  bool is_stylus_pressed{false};
  bool is_calibration_pressed{false};  // since the last set of the counters
  bool operator==(const DeviceReport&) const = default;
};

// One output report, ready for the bus.
struct HostReport {
  std::array<std::uint8_t, wire::kTeensyReportBytes> bytes{};
  std::size_t size{0};
  [[nodiscard]] std::span<const std::uint8_t> payload() const noexcept {
    return {bytes.data(), size};
  }
};

// Translation between bytes and values of the protocol. Pure and total: any bytes give a
// report or nothing, any numbers give bytes.
// Thread: any. RT: all THIMBLE_RT.

// Nothing when the length is not that of the form.
THIMBLE_RT [[nodiscard]] std::optional<DeviceReport> parse_device_report(
    std::span<const std::uint8_t> bytes, ReportForm form) noexcept;
// Currents a, b, c in ampere: rounded to mA, held within ±32.767 A; not finite: 0.
THIMBLE_RT [[nodiscard]] HostReport encode_currents(const std::array<double, 3>& current_a,
                                                    ReportForm form) noexcept;
// Makes all six counters zero and clears the calibration button's flag. The fields that hold
// currents in the other command are zero too, so that no firmware can read a current from it.
THIMBLE_RT [[nodiscard]] HostReport encode_zero_counters(ReportForm form) noexcept;

}  // namespace thimble::phantom
