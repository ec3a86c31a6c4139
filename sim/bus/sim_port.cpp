#include "sim/bus/sim_port.hpp"

#include <utility>

namespace thimble::sim {

SimPort::SimPort(bus::BusDeviceInfo model, bus::DeviceAddress address, bus::BusKind kind) noexcept
    : info_(std::move(model)) {
  info_.address = std::move(address);
  info_.kind = kind;
}

bool SimPort::unplug(Supply supply) noexcept {
  const bool has_news = is_plugged() || (supply == Supply::Goes && supply_ == Supply::Stays);
  if (!has_news) return false;
  supply_ = supply;
  if (supply == Supply::Goes) power_cuts_.fetch_add(1, std::memory_order_release);
  if (!is_plugged()) return true;
  generation_.fetch_add(1, std::memory_order_release);
  drop_host();
  return true;
}

bool SimPort::replug() noexcept {
  if (is_plugged()) return false;
  if (supply_ == Supply::Goes) power_cuts_.fetch_add(1, std::memory_order_release);
  generation_.fetch_add(1, std::memory_order_release);
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
