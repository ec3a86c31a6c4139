#pragma once

#include <span>
#include <string>
#include <vector>

#include "hal/bus/device_address.hpp"

namespace thimble::linux {

// What there is to name a device by.
struct DevicePlace {
  // Where it is plugged in, as the kernel calls it now: "1-4.2" (bus 1, port 4, port 2 of the hub
  // there); what is on no USB has a name of its own there. The kernel counts buses in the order in
  // which it finds them: another controller in the machine may change the first number.
  std::string port;
  unsigned interface_number{0};  // of a USB device that shows as several of them
  std::string serial_number;     // as the device says it; empty: none
  bool is_arm{false};            // a driver knows it, or another interface at its port
  // The same place whatever the kernel counts (usb_path.hpp); empty: there is none.
  std::string path{};
  // What the kernel calls the device itself, "0003:1234:0006.0001" or "ttyUSB1": a receiver's
  // interface may have several.
  std::string own_name{};
};

// Whether a serial number can stand in an address: 1 to 64 of A-Z a-z 0-9 . _ + - and not in the
// form of a port, or of a way to one, for which another device could be taken.
[[nodiscard]] bool is_usable_serial(const std::string& serial_number) noexcept;

// "1-4.2" of such a place, "1-4.2:1.1" of an interface above 0: no address, but what it was for
// configurations of before decision 0507.
// Thread: any. Not RT. Pure.
[[nodiscard]] std::string port_name(const DevicePlace& place);

// "hid:SERIAL" where no other port has that number, else "hid:PATH"; ":1.N" behind it for an
// interface N above 0 (decision 0246). What is no arm takes no number from one that is (0338), and
// no path. "hid:PORT" where there is no path, or another port has the same one; of several of one
// interface, ":OWN_NAME" behind all (0507). All differ where port, interface or own name do.
// Thread: any. Not RT. Pure.
[[nodiscard]] std::vector<bus::DeviceAddress> hid_addresses(std::span<const DevicePlace> places);
// The same of serial ports, "serial:SERIAL" and "serial:PATH".
[[nodiscard]] std::vector<bus::DeviceAddress> serial_addresses(std::span<const DevicePlace> places);
// The same of USB devices as such, "usb:SERIAL" and "usb:PATH" (decision 0505).
[[nodiscard]] std::vector<bus::DeviceAddress> usb_addresses(std::span<const DevicePlace> places);

}  // namespace thimble::linux
