#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace thimble::doctor {

// The longest report each way, without a report id.
struct ReportBytes {
  std::size_t input{0};
  std::size_t output{0};
  bool operator==(const ReportBytes&) const = default;
};

// What a HID report descriptor (HID 1.11, section 6.2.2) says of the lengths of reports. Total:
// bytes that are no descriptor, or tell of reports beyond 8 KiB, are nothing.
// Thread: any. Not RT. Pure.
[[nodiscard]] std::optional<ReportBytes> parse_report_descriptor(std::string_view bytes);

}  // namespace thimble::doctor
