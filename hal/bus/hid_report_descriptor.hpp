#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

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

}  // namespace thimble::bus
