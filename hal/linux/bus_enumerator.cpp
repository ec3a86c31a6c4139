#include "hal/linux/bus_enumerator.hpp"

#include <fcntl.h>

#include <cerrno>
#include <utility>

#include "hal/linux/serial_port.hpp"
#include "hal/linux/system_error.hpp"
#include "hal/linux/usb_device.hpp"

namespace thimble::linux {

BusEnumerator::BusEnumerator(const BusSettings& settings, UdevScan::IsArm is_arm)
    : settings_(settings),
      scan_(std::make_shared<UdevScan>(std::move(is_arm))),
      watch_(scan_),
      hids_(settings, calls_) {}

std::vector<bus::BusDeviceInfo> BusEnumerator::list() {
  std::vector<bus::BusDeviceInfo> devices;
  for (FoundDevice& device : scan_->devices()) {
    devices.push_back(std::move(device.info));
    devices.back().address.plugging = std::move(device.identity);
  }
  return devices;
}

Result<FoundDevice> BusEnumerator::find(const bus::DeviceAddress& address, bus::BusKind kind) {
  for (FoundDevice& device : scan_->devices()) {
    if (device.info.address != address || device.info.kind != kind) continue;
    if (address.plugging.empty() || address.plugging == device.identity) return std::move(device);
    return fail(Errc::NotFound, address.text + ": it was plugged in anew since it was looked at");
  }
  return fail(Errc::NotFound, "no device at " + address.text);
}

Result<void> BusEnumerator::check_same(const FoundDevice& opened) {
  if (is_among(opened, scan_->devices())) return {};
  return fail(Errc::NotFound, opened.info.address.text + ": it was unplugged while it was opened");
}

void BusEnumerator::note_open(const bus::DeviceAddress& address,
                              std::weak_ptr<const SharedDevice> shared) {
  const std::lock_guard guard(open_list_);
  std::erase_if(open_, [](const auto& entry) { return entry.second.expired(); });
  open_.insert_or_assign(address, std::move(shared));
}

Result<std::unique_ptr<bus::HidDevice>> BusEnumerator::open_hid(const bus::DeviceAddress& address) {
  const Result<FoundDevice> found = find(address, bus::BusKind::Hid);
  if (!found.has_value()) return tl::unexpected(found.error());
  auto device = hids_.open({found->node, found->hiddev}, found->info);
  if (!device.has_value()) return tl::unexpected(device.error());
  const Result<void> same = check_same(found.value());
  if (!same.has_value()) return tl::unexpected(same.error());
  note_open(address, (*device)->shared());
  return std::move(device.value());
}

Result<std::unique_ptr<bus::UsbDevice>> BusEnumerator::open_usb(const bus::DeviceAddress& address,
                                                                const bus::UsbClaim& claim) {
  const Result<FoundDevice> found = find(address, bus::BusKind::Usb);
  if (!found.has_value()) return tl::unexpected(found.error());
  Descriptor node(::open(found->node.c_str(), O_RDWR | O_CLOEXEC));
  if (node.get() < 0) {
    return tl::unexpected(system_error(found->node + " cannot be opened", errno).in(address.text));
  }
  // Before anything is sent to it.
  const Result<void> same = check_same(found.value());
  if (!same.has_value()) return tl::unexpected(same.error());
  auto device = UsbDevice::open(node.release(), found->info, claim, settings_.clock,
                                settings_.thread, settings_.process);
  if (!device.has_value()) return tl::unexpected(device.error());
  note_open(address, (*device)->shared());
  return std::move(device.value());
}

Result<std::unique_ptr<bus::SerialPort>> BusEnumerator::open_serial(
    const bus::DeviceAddress& address, const bus::SerialLine& line) {
  const Result<FoundDevice> found = find(address, bus::BusKind::Serial);
  if (!found.has_value()) return tl::unexpected(found.error());
  auto port = SerialPort::open(found->node, address, line, settings_);
  if (!port.has_value()) return tl::unexpected(port.error());
  const Result<void> same = check_same(found.value());
  if (!same.has_value()) return tl::unexpected(same.error());
  note_open(address, (*port)->shared());
  return std::move(port.value());
}

Result<SharedDevice> BusEnumerator::share(const bus::DeviceAddress& address) {
  const std::lock_guard guard(open_list_);
  const auto found = open_.find(address);
  const auto shared = found == open_.end() ? nullptr : found->second.lock();
  if (shared == nullptr) return fail(Errc::NotFound, address.text + " is not open");
  Result<SharedDevice> copy = share_again(*shared);
  if (!copy.has_value()) return tl::unexpected(copy.error().in(address.text));
  return copy;
}

}  // namespace thimble::linux
