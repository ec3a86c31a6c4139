#include "hal/bus/bus_enumerator.hpp"

namespace thimble::bus {

std::string_view to_string(BusKind kind) noexcept {
  switch (kind) {
    case BusKind::Hid:
      return "hid";
    case BusKind::Usb:
      return "usb";
    case BusKind::Serial:
      return "serial";
    case BusKind::Memory:
      return "memory";
  }
  return "unknown";
}

}  // namespace thimble::bus
