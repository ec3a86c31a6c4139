#include "hal/linux/hiddev.hpp"

#include <libudev.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <string_view>

#include "hal/linux/udev_handles.hpp"

namespace thimble::linux {
namespace {

constexpr unsigned kNoNumber = 0;
constexpr std::int64_t kLargestByte = 255;

}  // namespace

std::string hiddev_node_of(udev_device* hid) {
  udev_device* interface =
      ::udev_device_get_parent_with_subsystem_devtype(hid, "usb", "usb_interface");
  if (interface == nullptr) return {};
  udev* const context = ::udev_device_get_udev(hid);
  const UdevHandle<udev_enumerate> list(::udev_enumerate_new(context));
  if (list == nullptr) return {};
  ::udev_enumerate_add_match_parent(list.get(), interface);
  ::udev_enumerate_add_match_subsystem(list.get(), "usbmisc");
  ::udev_enumerate_scan_devices(list.get());
  for (udev_list_entry* entry = ::udev_enumerate_get_list_entry(list.get()); entry != nullptr;
       entry = ::udev_list_entry_get_next(entry)) {
    const UdevHandle<udev_device> device(
        ::udev_device_new_from_syspath(context, ::udev_list_entry_get_name(entry)));
    if (device == nullptr) continue;  // gone meanwhile
    const std::string_view name = udev_text(::udev_device_get_sysname(device.get()));
    if (!name.starts_with("hiddev")) continue;
    return std::string(udev_text(::udev_device_get_devnode(device.get())));
  }
  return {};
}

bool takes_plain_bytes(int hiddev, std::size_t bytes, DeviceCalls& calls) noexcept {
  if (bytes == 0 || bytes > HiddevOutput::kMaxBytes) return false;
  // The first report of all; the kernel says its number.
  hiddev_report_info report{};
  report.report_type = HID_REPORT_TYPE_OUTPUT;
  report.report_id = HID_REPORT_ID_FIRST;
  if (calls.control(hiddev, HIDIOCGREPORTINFO, &report) < 0) return false;
  if (report.report_id != kNoNumber || report.num_fields != 1) return false;
  hiddev_field_info field{};
  field.report_type = HID_REPORT_TYPE_OUTPUT;
  if (calls.control(hiddev, HIDIOCGFIELDINFO, &field) < 0) return false;
  // The number of a field's values, less one, is what it says for the field's index.
  return std::size_t{field.field_index} + 1 == bytes && field.logical_minimum == 0 &&
         field.logical_maximum == kLargestByte;
}

void have_reports_asked_for(int hiddev, DeviceCalls& calls) noexcept {
  // Any of the requests that need them; HIDIOCINITREPORT would ask each time.
  hiddev_usage_ref value{};
  value.report_type = HID_REPORT_TYPE_OUTPUT;
  value.report_id = kNoNumber;
  static_cast<void>(calls.control(hiddev, HIDIOCGUSAGE, &value));
}

HiddevOutput::HiddevOutput(int hiddev, DeviceCalls& calls) noexcept
    : hiddev_(hiddev), calls_(&calls) {
  values_.uref.report_type = HID_REPORT_TYPE_OUTPUT;
  values_.uref.report_id = kNoNumber;
  report_.report_type = HID_REPORT_TYPE_OUTPUT;
  report_.report_id = kNoNumber;
}

bool HiddevOutput::write(std::span<const std::uint8_t> report) noexcept {
  const std::size_t size = std::min(report.size(), kMaxBytes);
  values_.num_values = static_cast<std::uint32_t>(size);
  std::copy_n(report.begin(), size, std::begin(values_.values));
  return calls_->control(hiddev_, HIDIOCSUSAGES, &values_) >= 0 &&
         calls_->control(hiddev_, HIDIOCSREPORT, &report_) >= 0;
}

}  // namespace thimble::linux
