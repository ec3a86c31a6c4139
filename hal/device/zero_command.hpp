#pragma once

#include <cstddef>
#include <cstdint>

#include "hal/rt/static_vector.hpp"

namespace thimble {

// What takes the force away from an arm when written to its bus, whatever the arm is doing and
// whoever writes it: for the guard, which knows no device.
struct ZeroCommand {
  // The longest full-speed packet (USB 2.0, 5.7.3 and 5.8.3), which bounds a HID report here, too.
  static constexpr std::size_t kMaxBytes = 64;

  // OUT pipe of a USB device; 0: an output report of a HID device as HidDevice::submit() takes it,
  // its number first where reports are numbered, or the bytes of a message on a serial port.
  std::uint8_t endpoint{0};
  rt::StaticVector<std::uint8_t, kMaxBytes> bytes{};
  bool operator==(const ZeroCommand&) const = default;
};

// So many zeros taken in a row, by HapticDevice::write() or by a bus: an arm has had one. Ok tells
// of what was sent before, so the first may be about the force before the last, the second about
// the last one; the third is about a zero.
inline constexpr std::uint32_t kOksOfAZeroThatArrived = 3;

}  // namespace thimble
