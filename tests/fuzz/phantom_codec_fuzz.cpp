#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "drivers/phantom/phantom_codec.hpp"

// Any bytes give a report of the right form or nothing.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace phantom = thimble::phantom;
  const std::span<const std::uint8_t> bytes(data, size);
  for (const auto form : {phantom::ReportForm::Mbed, phantom::ReportForm::Teensy}) {
    const auto report = phantom::parse_device_report(bytes, form);
    if (report.has_value() != (size == phantom::report_bytes(form))) std::abort();
    if (!report) continue;
    const int d = report->gimbal_counts[0];
    if (form == phantom::ReportForm::Teensy && d > phantom::wire::kButtonThreshold &&
        !report->is_stylus_pressed) {
      std::abort();
    }
  }
  return 0;
}
