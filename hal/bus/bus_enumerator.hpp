#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/result.hpp"
#include "hal/bus/device_address.hpp"
#include "hal/bus/hid_device.hpp"
#include "hal/bus/serial_port.hpp"
#include "hal/bus/usb_device.hpp"

namespace thimble::bus {

enum class BusKind : std::uint8_t { Hid, Usb, Serial, Memory };
std::string_view to_string(BusKind kind) noexcept;

// What can be known of a device without touching it: a driver's probe sees only this.
struct BusDeviceInfo {
  DeviceAddress address;
  BusKind kind{};
  std::uint16_t vendor_id{0};
  std::uint16_t product_id{0};
  std::string manufacturer;
  std::string product;
  std::string serial_number;  // empty when the device has none
  // Of a HID device: the longest each way, with its number (HidReportLengths); 0: none, or not
  // known.
  std::size_t input_report_bytes{0};
  std::size_t output_report_bytes{0};
  bool has_report_ids{false};              // of a HID device: see HidReport
  std::vector<UsbEndpointInfo> endpoints;  // of a USB device, in the order of its descriptors
  // What the kernel calls its place on USB today, "1-4"; empty: not known, or it is on none. No
  // address: the kernel may count anew.
  std::string port{};
  bool operator==(const BusDeviceInfo&) const = default;
};

struct BusEvent {
  enum class Kind : std::uint8_t { Arrived, Left };
  Kind kind{};
  BusDeviceInfo device;
};

// Lists and opens devices of one or several buses, and tells of arrivals and departures.
//
// Thread: list() and open_*() from any non-RT thread, for several devices at once; poll_event()
// from one. A bus of the simulation, where nothing waits: all from one. Not RT. Ownership: must
// outlive the devices it opened. Errors: each call says its own.
class BusEnumerator {
 public:
  virtual ~BusEnumerator() = default;
  // The address of each says when it was plugged in, too (DeviceAddress::plugging): who opens by it
  // opens what was listed, or nothing.
  [[nodiscard]] virtual std::vector<BusDeviceInfo> list() = 0;
  // The next arrival or departure since construction, in order; devices present at
  // construction are not announced. Never waits.
  [[nodiscard]] virtual std::optional<BusEvent> poll_event() = 0;
  // NotFound, also where another device stands there, or the same one was plugged in anew, since
  // that address was listed; that or InvalidArgument for a device of another kind; Busy (opened
  // already), Permission or System.
  [[nodiscard]] virtual Result<std::unique_ptr<HidDevice>> open_hid(
      const DeviceAddress& address) = 0;
  // The same, and InvalidArgument for a claim that the device's descriptors do not fill. Its IN
  // pipes are asked from now on; nothing is sent to it. Unsupported where a bus has no such
  // devices.
  [[nodiscard]] virtual Result<std::unique_ptr<UsbDevice>> open_usb(const DeviceAddress& address,
                                                                    const UsbClaim& claim);
  // The same, and InvalidArgument for a line that the port cannot be set to. Nothing is sent.
  // Unsupported where a bus has no serial ports.
  [[nodiscard]] virtual Result<std::unique_ptr<SerialPort>> open_serial(
      const DeviceAddress& address, const SerialLine& line);
};

}  // namespace thimble::bus
