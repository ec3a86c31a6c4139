#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hal/linux/device_readings.hpp"

namespace thimble::linux {

// What sysfs and libudev say of one device, word for word; what the device says of itself is among
// it, and is anything. Of what is not there: empty.
struct DeviceTexts {
  // The kernel's own.
  std::string node;      // "/dev/hidraw0"
  std::string hiddev;    // "/dev/usb/hiddev0"
  std::string port;      // "1-4" of the USB device; of what is on none, its HID device's name
  std::string path;      // of that USB device whatever the kernel counts (usb_path.hpp)
  std::string name;      // "ttyACM0", "0003:1234:0006.0001" of a HID device
  bool is_on_usb{true};  // whether there is such a USB device
  // Of the HID device: properties, and its report descriptor's bytes.
  std::string hid_id;  // "0003:00001234:00000006"
  std::string hid_name;
  std::string hid_uniq;
  std::string report_descriptor;
  // Of the USB device: attributes, and its descriptors' bytes.
  std::string vendor_id;  // "1234"
  std::string product_id;
  std::string manufacturer;
  std::string product;
  std::string serial_number;
  std::string configuration;  // "1"
  std::string descriptors;
  std::string interface_number;  // of the interface that the node hangs on, "00"
};

// Longer texts are cut: a USB string has at most 126 letters.
inline constexpr std::size_t kMaxTextBytes = 256;

// What that is, but for its identity, and of HID devices and serial ports their address. Words are
// printable ASCII (printable_text.hpp) of kMaxTextBytes at most; numbers that are none count as 0;
// nothing without a node, vendor and product. Of the descriptors as parse_report_descriptor() and
// parse_usb_descriptors().
// Thread: any. Not RT. Pure. Total: any bytes.
[[nodiscard]] std::optional<ReadDevice> hid_device_of(const DeviceTexts& texts);
[[nodiscard]] std::optional<ReadDevice> serial_port_of(const DeviceTexts& texts);
[[nodiscard]] std::optional<ReadDevice> usb_device_of(const DeviceTexts& texts);

// The same devices in the same order; HID devices and serial ports have addresses by their places
// among each other (hid_address.hpp). `is_arm`: as UdevScan's; may be empty.
// Thread: any. Not RT. Total.
[[nodiscard]] std::vector<FoundDevice> with_addresses(
    std::vector<ReadDevice> read, const std::function<bool(const bus::BusDeviceInfo&)>& is_arm);

}  // namespace thimble::linux
