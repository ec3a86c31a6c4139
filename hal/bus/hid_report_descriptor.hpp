#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace thimble::bus {

// The longest report each way, with its number where reports are numbered.
struct HidReportLengths {
  std::size_t input_bytes{0};
  std::size_t output_bytes{0};
  bool has_report_ids{false};
  bool operator==(const HidReportLengths&) const = default;
};

// What a HID report descriptor (HID 1.11, section 6.2.2) says of the lengths of reports. Total:
// bytes that are no descriptor, or tell of reports beyond 8 KiB, are nothing.
// Thread: any. Not RT. Pure.
[[nodiscard]] std::optional<HidReportLengths> parse_report_descriptor(std::string_view bytes);

// The plainest descriptor of a device with such reports: vendor-defined bytes, one report each way
// (none for a length of 0), of at most 65,535 bytes. Reports without numbers: `has_report_ids` is
// not looked at. Thread: any. Not RT. Pure.
[[nodiscard]] std::vector<std::uint8_t> plain_report_descriptor(const HidReportLengths& lengths);

// One numbered report: `bytes` behind its number, at most 65,535.
struct HidNumberedReport {
  std::uint8_t number{1};
  bool is_output{false};
  std::size_t bytes{0};
};
// The same of a device that numbers its reports.
[[nodiscard]] std::vector<std::uint8_t> plain_report_descriptor(
    std::span<const HidNumberedReport> reports);

}  // namespace thimble::bus
