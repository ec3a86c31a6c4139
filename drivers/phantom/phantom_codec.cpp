#include "drivers/phantom/phantom_codec.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace thimble::phantom {
namespace {

std::int16_t load_int16(std::span<const std::uint8_t> bytes, std::size_t field) noexcept {
  const unsigned low = bytes[2 * field];
  const unsigned high = bytes[2 * field + 1];
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(low | (high << 8U)));
}

void store_int16(HostReport& report, std::size_t field, std::int16_t value) noexcept {
  const auto bits = static_cast<std::uint16_t>(value);
  report.bytes[2 * field] = static_cast<std::uint8_t>(bits & 0xffU);
  report.bytes[2 * field + 1] = static_cast<std::uint8_t>(bits >> 8U);
}

// Symmetric: a firmware that negates the lowest int16 gets the same sign back.
std::int16_t to_milliampere(double current_a) noexcept {
  if (!std::isfinite(current_a)) return 0;
  constexpr double kLimit = std::numeric_limits<std::int16_t>::max();
  return static_cast<std::int16_t>(std::lround(std::clamp(current_a * 1000, -kLimit, kLimit)));
}

}  // namespace

std::optional<ReportForm> form_of(std::size_t input_bytes, std::size_t output_bytes) noexcept {
  if (input_bytes != output_bytes) return std::nullopt;
  if (input_bytes == wire::kMbedReportBytes) return ReportForm::Mbed;
  if (input_bytes == wire::kTeensyReportBytes) return ReportForm::Teensy;
  return std::nullopt;
}

std::optional<DeviceReport> parse_device_report(std::span<const std::uint8_t> bytes,
                                                ReportForm form) noexcept {
  if (bytes.size() != report_bytes(form)) return std::nullopt;
  DeviceReport report;
  for (std::size_t i = 0; i < 3; ++i) {
    report.base_counts[i] = load_int16(bytes, wire::kEncoderA + i);
    report.gimbal_counts[i] = load_int16(bytes, wire::kEncoderD + i);
  }
  std::int16_t& d = report.gimbal_counts[0];
  if (form == ReportForm::Teensy && d > wire::kButtonThreshold) {
    report.is_stylus_pressed = true;
    d = static_cast<std::int16_t>(d - wire::kButtonFold);
  }
  const auto info = static_cast<std::uint16_t>(load_int16(bytes, wire::kInfo));
  report.is_calibration_pressed = (info & wire::kInfoCalibrationPressed) != 0;
  return report;
}

HostReport encode_currents(const std::array<double, 3>& current_a, ReportForm form) noexcept {
  HostReport report;
  report.size = report_bytes(form);
  for (std::size_t i = 0; i < 3; ++i) {
    store_int16(report, wire::kCurrentA + i, to_milliampere(current_a[i]));
  }
  store_int16(report, wire::kCommand, wire::kCommandCurrents);
  return report;
}

HostReport encode_zero_counters(ReportForm form) noexcept {
  HostReport report;
  report.size = report_bytes(form);
  store_int16(report, wire::kCommand, wire::kCommandSetCounters);
  return report;
}

}  // namespace thimble::phantom
