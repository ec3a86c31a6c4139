#pragma once

#include <compare>
#include <string>
#include <string_view>

namespace thimble::bus {

// Where a device is: "hid:SERIAL" or "hid:PATH", "usb:SERIAL" or "usb:PATH" with a path such as
// "pci-0000:00:14.0-usb-0:4", "serial:SERIAL" or "serial:PATH", "pci:0000:03:00.0",
// "sim:phantom-vintage"; of an interface above 0 ":1.N" is behind it, of one of several devices of
// an interface what the kernel calls it, ":ttyUSB1" (decision 0507). The scheme says which bus
// implementation serves it. Nothing above the enumerator looks into it, but for whether it is a
// simulated one: what else has to be known of a device, its bus says.
struct DeviceAddress {
  std::string text;
  // Which time it was plugged in, in the words of the bus that listed it; empty: whichever. No part
  // of the name, and not compared.
  std::string plugging{};

  friend bool operator==(const DeviceAddress& a, const DeviceAddress& b) noexcept {
    return a.text == b.text;
  }
  friend std::strong_ordering operator<=>(const DeviceAddress& a, const DeviceAddress& b) noexcept {
    return a.text <=> b.text;
  }
};

// The scheme of models on buses in virtual time; what follows it is the model's name.
inline constexpr std::string_view kSimScheme = "sim:";
[[nodiscard]] constexpr bool is_simulated(std::string_view address) noexcept {
  return address.starts_with(kSimScheme);
}
// Empty for other addresses.
[[nodiscard]] constexpr std::string_view simulated_model(std::string_view address) noexcept {
  return is_simulated(address) ? address.substr(kSimScheme.size()) : std::string_view{};
}

}  // namespace thimble::bus
