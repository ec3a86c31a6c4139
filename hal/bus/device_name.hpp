#pragma once

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

}  // namespace thimble::bus
