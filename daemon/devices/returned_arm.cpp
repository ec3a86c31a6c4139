#include "daemon/devices/returned_arm.hpp"

#include <array>
#include <cstdio>
#include <string>

namespace thimble::devices {
namespace {

constexpr const char* kCure =
    "; plug in the arm that left, or restart the daemon to start anew with this one";

std::string ids_of(const bus::BusDeviceInfo& info) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "%04x:%04x", static_cast<unsigned>(info.vendor_id),
                static_cast<unsigned>(info.product_id));
  return text.data();
}

std::string serial_of(const bus::BusDeviceInfo& info) {
  return info.serial_number.empty() ? "no serial number" : "serial number " + info.serial_number;
}

}  // namespace

Result<void> check_same_device(const bus::BusDeviceInfo& left, const bus::BusDeviceInfo& returned) {
  std::string what;
  if (ids_of(left) != ids_of(returned)) what = ids_of(returned) + " instead of " + ids_of(left);
  if (left.serial_number != returned.serial_number) {
    what += (what.empty() ? "" : ", ") + serial_of(returned) + " instead of " + serial_of(left);
  }
  const bool is_form_same = left.kind == returned.kind &&
                            left.input_report_bytes == returned.input_report_bytes &&
                            left.output_report_bytes == returned.output_report_bytes;
  if (!is_form_same) what += std::string(what.empty() ? "" : ", ") + "reports of another form";
  if (what.empty()) return {};
  return fail(Errc::InvalidArgument,
              "another device stands in the place of the arm that left (" + what + ")" + kCure);
}

Result<void> check_same_limits(const HapticCapabilities& left, const HapticCapabilities& returned) {
  if (left == returned) return {};
  return fail(Errc::InvalidArgument, "it is of model " + returned.model +
                                         " with other limits than the arm that left (" +
                                         left.model + ")" + kCure);
}

}  // namespace thimble::devices
