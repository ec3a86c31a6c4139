#include "hal/linux/bus_enumerator.hpp"

#include <fcntl.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "hal/linux/hiddev.hpp"
#include "hal/linux/serial_port.hpp"
#include "hal/linux/system_error.hpp"
#include "hal/linux/usb_device.hpp"

namespace thimble::linux {
namespace {

using bus::BusEvent;

constexpr const char* kRefused = " cannot be opened";

// The same device, under the same address, and described alike.
bool is_among(const FoundDevice& wanted, const std::vector<FoundDevice>& devices) {
  return std::any_of(devices.begin(), devices.end(), [&](const FoundDevice& device) {
    return device.identity == wanted.identity && device.info == wanted.info;
  });
}

Result<SharedDevice> share_open(const bus::DeviceAddress& address, int node) {
  Descriptor shared(::fcntl(node, F_DUPFD_CLOEXEC, 0));
  if (shared.get() < 0) return tl::unexpected(system_error(address.text + kRefused, errno));
  return SharedDevice{std::move(shared), {}, false};
}

// Beside the first way: what it cannot be had for is no reason to have none.
Descriptor open_second_way(const FoundDevice& device) {
  if (device.hiddev.empty() || device.info.has_report_ids) return {};
  Descriptor hiddev(::open(device.hiddev.c_str(), O_RDONLY | O_CLOEXEC));
  KernelCalls calls;
  const bool is_usable =
      hiddev.get() >= 0 && takes_plain_bytes(hiddev.get(), device.info.output_report_bytes, calls);
  return is_usable ? std::move(hiddev) : Descriptor();
}

}  // namespace

BusEnumerator::BusEnumerator(const BusSettings& settings, UdevScan::IsArm is_arm)
    : settings_(settings), scan_(std::move(is_arm)), known_(scan_.devices()), hids_(settings) {}

std::vector<bus::BusDeviceInfo> BusEnumerator::list() {
  std::vector<bus::BusDeviceInfo> devices;
  for (FoundDevice& device : scan_.devices()) devices.push_back(std::move(device.info));
  return devices;
}

std::optional<BusEvent> BusEnumerator::poll_event() {
  if (events_.empty() && scan_.has_news()) note_changes();
  if (events_.empty()) return std::nullopt;
  BusEvent event = std::move(events_.front());
  events_.pop_front();
  return event;
}

void BusEnumerator::note_changes() {
  std::vector<FoundDevice> now = scan_.devices();
  for (const FoundDevice& device : known_) {
    if (!is_among(device, now)) events_.push_back({BusEvent::Kind::Left, device.info});
  }
  for (const FoundDevice& device : now) {
    if (!is_among(device, known_)) events_.push_back({BusEvent::Kind::Arrived, device.info});
  }
  known_ = std::move(now);
}

Result<FoundDevice> BusEnumerator::find(const bus::DeviceAddress& address, bus::BusKind kind) {
  for (FoundDevice& device : scan_.devices()) {
    if (device.info.address == address && device.info.kind == kind) return std::move(device);
  }
  return fail(Errc::NotFound, "no device at " + address.text);
}

Result<void> BusEnumerator::check_same(const FoundDevice& opened) {
  if (is_among(opened, scan_.devices())) return {};
  return fail(Errc::NotFound, opened.info.address.text + ": it was unplugged while it was opened");
}

Result<Descriptor> BusEnumerator::open_node(const FoundDevice& device, int flags) {
  Descriptor node(::open(device.node.c_str(), flags | O_CLOEXEC));
  if (node.get() < 0) {
    return tl::unexpected(system_error(device.node + kRefused, errno).in(device.info.address.text));
  }
  if (Result<void> same = check_same(device); !same.has_value()) {
    return tl::unexpected(same.error());
  }
  return node;
}

Result<std::unique_ptr<bus::HidDevice>> BusEnumerator::open_hid(const bus::DeviceAddress& address) {
  const Result<FoundDevice> found = find(address, bus::BusKind::Hid);
  if (!found.has_value()) return tl::unexpected(found.error());
  Result<std::unique_ptr<bus::HidDevice>> device =
      hids_.open({found->node, found->hiddev}, found->info);
  if (!device.has_value()) return device;
  const Result<void> same = check_same(found.value());
  if (!same.has_value()) return tl::unexpected(same.error());
  return device;
}

Result<std::unique_ptr<bus::UsbDevice>> BusEnumerator::open_usb(const bus::DeviceAddress& address,
                                                                const bus::UsbClaim& claim) {
  const Result<FoundDevice> found = find(address, bus::BusKind::Usb);
  if (!found.has_value()) return tl::unexpected(found.error());
  Result<Descriptor> node = open_node(found.value(), O_RDWR);
  if (!node.has_value()) return tl::unexpected(node.error());
  // Whoever shares it shares the claim, which belongs to what is open, not to its number.
  usb_nodes_.insert_or_assign(address, Descriptor(::fcntl(node->get(), F_DUPFD_CLOEXEC, 0)));
  return UsbDevice::open(node->release(), found->info, claim, settings_.clock, settings_.thread,
                         settings_.process);
}

Result<std::unique_ptr<bus::SerialPort>> BusEnumerator::open_serial(
    const bus::DeviceAddress& address, const bus::SerialLine& line) {
  const Result<FoundDevice> found = find(address, bus::BusKind::Serial);
  if (!found.has_value()) return tl::unexpected(found.error());
  auto port = SerialPort::open(found->node, address, line, settings_);
  if (!port.has_value()) return tl::unexpected(port.error());
  const Result<void> same = check_same(found.value());
  if (!same.has_value()) return tl::unexpected(same.error());
  serial_nodes_[address] = (*port)->node();
  return std::move(port.value());
}

Result<SharedDevice> BusEnumerator::share(const bus::DeviceAddress& address) {
  const auto usb = usb_nodes_.find(address);
  if (usb != usb_nodes_.end()) return share_open(address, usb->second.get());
  const auto serial = serial_nodes_.find(address);
  if (serial != serial_nodes_.end()) {
    const std::shared_ptr<const Descriptor> node = serial->second.lock();
    if (node == nullptr) return fail(Errc::NotFound, address.text + " is not open");
    return share_open(address, node->get());
  }
  const Result<FoundDevice> found = find(address, bus::BusKind::Hid);
  if (!found.has_value()) return tl::unexpected(found.error());
  SharedDevice shared;
  shared.takes_leading_zero = !found->info.has_report_ids;
  shared.hiddev = open_second_way(found.value());
  // After the second way: it is the same device's when it is still there now.
  Result<Descriptor> node = open_node(found.value(), O_WRONLY);
  if (!node.has_value()) return tl::unexpected(node.error());
  shared.node = std::move(node.value());
  return shared;
}

}  // namespace thimble::linux
