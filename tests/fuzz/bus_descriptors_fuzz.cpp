#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "hal/base/check.hpp"
#include "hal/bus/hid_report_descriptor.hpp"
#include "hal/bus/usb_descriptor.hpp"

// Whatever a device says of itself gives lengths and endpoints or nothing.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thimble::bus;
  const auto reports = parse_report_descriptor({reinterpret_cast<const char*>(data), size});
  if (reports) THIMBLE_CHECK(reports->input_bytes <= 8193 && reports->output_bytes <= 8193);
  const auto endpoints = parse_usb_descriptors({data, size}, 1);
  if (endpoints) THIMBLE_CHECK(endpoints->size() <= 30 && endpoints->size() * 7 <= size);
  return 0;
}
