#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hal/bus/bus_enumerator.hpp"

// Descriptors of a full-speed device with one configuration, as a host asks for them: USB 2.0,
// section 9.6, and HID 1.11, section 6.2.
namespace thimble::sim {

using DescriptorBytes = std::vector<std::uint8_t>;

// USB-IF, defined class codes.
inline constexpr std::uint8_t kUsbClassHid = 3;
inline constexpr std::uint8_t kUsbClassVendor = 0xFF;

struct UsbInterface {
  std::uint8_t number{0};
  std::uint8_t class_code{kUsbClassVendor};
  std::uint8_t subclass{0};
  std::uint8_t protocol{0};
  DescriptorBytes class_descriptors{};  // that stand between its own and its endpoints'
};

// `info`: ids, names and endpoints, each of which says whose it is. Without `interfaces` it has
// one: of the HID class where `report_descriptor` has bytes, else the vendor's.
struct UsbPersona {
  bus::BusDeviceInfo info;
  DescriptorBytes report_descriptor;
  std::uint8_t class_code{0};  // the device's; 0: its interfaces say
  std::vector<UsbInterface> interfaces{};
};
// All that it has. Thread: any. Not RT. Pure.
[[nodiscard]] std::vector<UsbInterface> interfaces_of(const UsbPersona& persona);

// Whole; a host takes as much as it asked for. Nothing where there is no such descriptor: `type`
// and `index` are the two bytes of wValue. Thread: any. Not RT. Pure.
[[nodiscard]] DescriptorBytes usb_descriptor(const UsbPersona& persona, std::uint8_t type,
                                             std::uint8_t index);

}  // namespace thimble::sim
