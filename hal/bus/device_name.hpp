#pragma once

#include <cstddef>
#include <string_view>

namespace thimble::bus {

// Of a serial number that can stand in an address.
inline constexpr std::string_view kSerialLetters =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._+-";

// Whether a bus of this machine could give this name behind its scheme (device_address.hpp): a
// serial number or a port, both with an interface behind them, or what the kernel calls a device
// that is on no USB. Total; pure.
[[nodiscard]] constexpr bool is_device_name(std::string_view name) noexcept {
  if (name.empty()) return false;
  for (const char letter : name) {
    if (letter != ':' && kSerialLetters.find(letter) == std::string_view::npos) return false;
  }
  return true;
}

// "0403:cb48", as lsusb shows what every device of a kind has. Total; pure.
[[nodiscard]] constexpr bool are_usb_ids(std::string_view name) noexcept {
  constexpr std::string_view kHexadecimal = "0123456789abcdefABCDEF";
  constexpr std::size_t kDigits = 4;
  if (name.size() != 2 * kDigits + 1 || name[kDigits] != ':') return false;
  return name.substr(0, kDigits).find_first_not_of(kHexadecimal) == std::string_view::npos &&
         name.substr(kDigits + 1).find_first_not_of(kHexadecimal) == std::string_view::npos;
}

// "1" or "1.4" of hubs: each port a number from 1 on. Total; pure.
[[nodiscard]] constexpr bool are_usb_ports(std::string_view text) noexcept {
  bool is_first = true;  // digit of a port
  for (const char letter : text) {
    const bool is_dot = letter == '.';
    if (!is_dot && (letter < '0' || letter > '9')) return false;
    if (is_first && (is_dot || letter == '0')) return false;
    is_first = is_dot;
  }
  return !is_first;
}

// Whether it is a way to a controller, whatever that is called, and from there to a port, with no
// interface behind it: "pci-0000:00:14.0-usb-0:1.4" (decision 0507). Total; pure.
[[nodiscard]] constexpr bool is_usb_path(std::string_view name) noexcept {
  const std::size_t colon = name.rfind(':');
  if (colon == std::string_view::npos || !are_usb_ports(name.substr(colon + 1))) return false;
  const std::string_view way = name.substr(0, colon);
  for (const std::string_view hub : {std::string_view("-usb-0"), std::string_view("-usbv3-0")}) {
    if (way.ends_with(hub) && way.size() > hub.size()) return true;
  }
  return false;
}

// Whether a bus of this machine could give this address: as its name may be, on USB without an
// interface; neither ids, nor an interface 0, which is left out. Total; pure.
[[nodiscard]] constexpr bool is_device_address(std::string_view address) noexcept {
  const std::size_t colon = address.find(':');
  if (colon == std::string_view::npos) return false;
  const std::string_view name = address.substr(colon + 1);
  if (!is_device_name(name) || are_usb_ids(name) || name.ends_with(":1.0")) return false;
  if (address.substr(0, colon) != "usb") return true;
  return name.find(':') == std::string_view::npos || is_usb_path(name);
}

}  // namespace thimble::bus
