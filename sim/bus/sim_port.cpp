#include "sim/bus/sim_port.hpp"

#include <utility>

namespace thimble::sim {

SimPort::SimPort(bus::BusDeviceInfo model, bus::DeviceAddress address, bus::BusKind kind) noexcept
    : info_(std::move(model)) {
  info_.address = std::move(address);
  info_.kind = kind;
}

bool SimPort::unplug(Supply supply) noexcept {
  const bool was_plugged = is_plugged();
  const bool is_cut = supply == Supply::Goes && (was_plugged || supply_ == Supply::Stays);
  if (!was_plugged && !is_cut) return false;
  supply_ = supply;
  state_.fetch_add((is_cut ? kOneCut : 0) + (was_plugged ? 1 : 0), std::memory_order_release);
  if (was_plugged) drop_host();
  return true;
}

bool SimPort::replug() noexcept {
  if (is_plugged()) return false;
  state_.fetch_add((supply_ == Supply::Goes ? kOneCut : 0) + 1, std::memory_order_release);
  return true;
}

Result<std::unique_ptr<bus::HidDevice>> SimPort::open_hid() {
  return fail(Errc::InvalidArgument, info_.address.text + " is no HID device");
}

Result<std::unique_ptr<bus::UsbDevice>> SimPort::open_usb(const bus::UsbClaim& /*claim*/) {
  return fail(Errc::InvalidArgument, info_.address.text + " is no bare USB device");
}

Result<std::unique_ptr<bus::SerialPort>> SimPort::open_serial(const bus::SerialLine& /*line*/) {
  return fail(Errc::InvalidArgument, info_.address.text + " is no serial port");
}

Result<void> SimPort::check_free(bool is_taken) const {
  if (!is_plugged()) return fail(Errc::NotFound, info_.address.text + " is unplugged");
  if (is_taken) return fail(Errc::Busy, info_.address.text + " is open already");
  return {};
}

}  // namespace thimble::sim
