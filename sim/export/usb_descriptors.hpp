#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hal/bus/bus_enumerator.hpp"

// Descriptors of a full-speed device with one configuration of one interface, as a host asks for
// them: USB 2.0, section 9.6, and HID 1.11, section 6.2.
namespace thimble::sim {

// `info`: ids, names and endpoints; of an interface of the HID class where `report_descriptor` has
// bytes, else the vendor's.
struct UsbPersona {
  bus::BusDeviceInfo info;
  std::vector<std::uint8_t> report_descriptor;
};
inline constexpr std::uint8_t kUsbClassHid = 3;
inline constexpr std::uint8_t kUsbClassVendor = 0xFF;
[[nodiscard]] std::uint8_t interface_class(const UsbPersona& persona) noexcept;

// Whole; a host takes as much as it asked for. Nothing where there is no such descriptor: `type`
// and `index` are the two bytes of wValue. Thread: any. Not RT. Pure.
using DescriptorBytes = std::vector<std::uint8_t>;
[[nodiscard]] DescriptorBytes usb_descriptor(const UsbPersona& persona, std::uint8_t type,
                                             std::uint8_t index);

}  // namespace thimble::sim
