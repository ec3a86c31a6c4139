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

Result<std::unique_ptr<UsbDevice>> BusEnumerator::open_usb(const DeviceAddress& address,
                                                           const UsbClaim& /*claim*/) {
  return fail(Errc::Unsupported, address.text + " is on a bus that opens no USB devices");
}

Result<std::unique_ptr<SerialPort>> BusEnumerator::open_serial(const DeviceAddress& address,
                                                               const SerialLine& /*line*/) {
  return fail(Errc::Unsupported, address.text + " is on a bus that opens no serial ports");
}

}  // namespace thimble::bus
