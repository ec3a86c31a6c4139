#pragma once

#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "hal/bus/bus_enumerator.hpp"
#include "hal/linux/bus_settings.hpp"
#include "hal/linux/descriptor.hpp"
#include "hal/linux/hid_device.hpp"
#include "hal/linux/shared_device.hpp"
#include "hal/linux/udev_scan.hpp"

namespace thimble::linux {

// The HID devices, serial ports and USB devices of this machine. Addresses: hid_address.hpp, and
// "usb:1-4" for port 4 of bus 1. To list opens no device and sends nothing.
//
// What came and went is found by looking again when udevd says that something has: a device that
// left and returned between two looks is told of as Left, then Arrived.
//
// Thread, errors: as bus::BusEnumerator; open_hid() as HidHost::open(), open_usb() as
// UsbDevice::open(), open_serial() as SerialPort::open(). Ownership: must outlive the devices it
// opened.
class BusEnumerator final : public bus::BusEnumerator {
 public:
  explicit BusEnumerator(const BusSettings& settings, UdevScan::IsArm is_arm = {});

  [[nodiscard]] std::vector<bus::BusDeviceInfo> list() override;
  [[nodiscard]] std::optional<bus::BusEvent> poll_event() override;
  [[nodiscard]] Result<std::unique_ptr<bus::HidDevice>> open_hid(
      const bus::DeviceAddress& address) override;
  [[nodiscard]] Result<std::unique_ptr<bus::UsbDevice>> open_usb(
      const bus::DeviceAddress& address, const bus::UsbClaim& claim) override;
  [[nodiscard]] Result<std::unique_ptr<bus::SerialPort>> open_serial(
      const bus::DeviceAddress& address, const bus::SerialLine& line) override;
  // Descriptors of a device that this opened, for a process that may have to let the arm go when
  // this one cannot: of a USB device with the same claim, of a serial port the very node, for
  // nobody else can open it. NotFound, Permission or System; where only the second way of a HID
  // device cannot be had, it is left out.
  [[nodiscard]] Result<SharedDevice> share(const bus::DeviceAddress& address);

 private:
  void note_changes();
  [[nodiscard]] Result<FoundDevice> find(const bus::DeviceAddress& address, bus::BusKind kind);
  // NotFound when what was opened by the name of its node is no longer what it was.
  [[nodiscard]] Result<void> check_same(const FoundDevice& opened);
  [[nodiscard]] Result<Descriptor> open_node(const FoundDevice& device, int flags);

  BusSettings settings_;
  UdevScan scan_;
  std::vector<FoundDevice> known_;  // what poll_event() has told of
  std::deque<bus::BusEvent> events_;
  HidHost hids_;
  std::map<bus::DeviceAddress, Descriptor> usb_nodes_;  // of the newest opening of each
  std::map<bus::DeviceAddress, std::weak_ptr<const Descriptor>> serial_nodes_;
};

}  // namespace thimble::linux
