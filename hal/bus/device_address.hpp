#pragma once

#include <compare>
#include <string>

namespace thimble::bus {

// Where a device is: "hid:SERIAL" or "hid:PORTPATH", "usb:1-4", "pci:0000:03:00.0",
// "sim:phantom-vintage". The scheme says which bus implementation serves it; nothing above
// the enumerator looks at it otherwise.
struct DeviceAddress {
  std::string text;
  auto operator<=>(const DeviceAddress&) const = default;
};

}  // namespace thimble::bus
