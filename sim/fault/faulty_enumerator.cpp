#include "sim/fault/faulty_enumerator.hpp"

#include <algorithm>
#include <utility>

namespace thimble::sim {

void FaultyEnumerator::set_plan(const bus::DeviceAddress& address, FaultPlan plan) {
  cables_[address].plan = std::move(plan);
}

FaultCounts FaultyEnumerator::injected(const bus::DeviceAddress& address) const {
  const auto cable = cables_.find(address);
  return cable == cables_.end() ? FaultCounts{} : cable->second.tally->read();
}

bool FaultyEnumerator::is_on(const Cable& cable, FaultKind kind) const noexcept {
  const MonotonicTime now = clock_->now();
  return std::any_of(
      cable.plan.script.begin(), cable.plan.script.end(),
      [&](const ScriptedFault& fault) { return fault.kind == kind && fault.covers(now); });
}

bool FaultyEnumerator::is_delaying() {
  const auto slow = std::find_if(cables_.begin(), cables_.end(), [&](const auto& entry) {
    return is_on(entry.second, FaultKind::DelayEvents);
  });
  if (slow == cables_.end()) return false;
  while (std::optional<bus::BusEvent> event = buses_->poll_event()) {
    slow->second.tally->add(FaultKind::DelayEvents);
    late_.push_back(std::move(*event));
  }
  return true;
}

std::optional<bus::BusEvent> FaultyEnumerator::next_event() {
  if (late_.empty()) return buses_->poll_event();
  std::optional<bus::BusEvent> event = std::move(late_.front());
  late_.pop_front();
  return event;
}

std::optional<bus::BusEvent> FaultyEnumerator::poll_event() {
  if (is_delaying()) return std::nullopt;
  while (std::optional<bus::BusEvent> event = next_event()) {
    const auto cable = cables_.find(event->device.address);
    if (cable == cables_.end() || !is_on(cable->second, FaultKind::LoseEvents)) return event;
    cable->second.tally->add(FaultKind::LoseEvents);
  }
  return std::nullopt;
}

Result<void> FaultyEnumerator::check_willing(const bus::DeviceAddress& address) {
  const auto cable = cables_.find(address);
  if (cable == cables_.end() || !is_on(cable->second, FaultKind::RefuseOpen)) return {};
  cable->second.tally->add(FaultKind::RefuseOpen);
  return fail(Errc::Busy, address.text + " is held by somebody else");
}

Result<std::unique_ptr<bus::HidDevice>> FaultyEnumerator::open_hid(
    const bus::DeviceAddress& address) {
  const Result<void> is_willing = check_willing(address);
  if (!is_willing.has_value()) return tl::unexpected(is_willing.error());
  Result<std::unique_ptr<bus::HidDevice>> device = buses_->open_hid(address);
  if (!device.has_value()) return device;
  const Cable& cable = cables_[address];
  return std::make_unique<FaultyHid>(std::move(device.value()), *clock_, cable.plan, cable.tally);
}

Result<std::unique_ptr<bus::UsbDevice>> FaultyEnumerator::open_usb(
    const bus::DeviceAddress& address, const bus::UsbClaim& claim) {
  const Result<void> is_willing = check_willing(address);
  if (!is_willing.has_value()) return tl::unexpected(is_willing.error());
  Result<std::unique_ptr<bus::UsbDevice>> device = buses_->open_usb(address, claim);
  if (!device.has_value()) return device;
  const std::vector<bus::BusDeviceInfo> devices = buses_->list();
  const auto info = std::find_if(devices.begin(), devices.end(), [&](const auto& candidate) {
    return candidate.address == address;
  });
  if (info == devices.end()) return fail(Errc::NotFound, address.text + " is gone again");
  const auto pipes = bus::resolve_claim(claim, info->endpoints);
  if (!pipes.has_value()) return tl::unexpected(pipes.error().in(address.text));
  const Cable& cable = cables_[address];
  return std::make_unique<FaultyUsb>(std::move(device.value()), pipes.value(), *clock_, cable.plan,
                                     cable.tally);
}

Result<std::unique_ptr<bus::SerialPort>> FaultyEnumerator::open_serial(
    const bus::DeviceAddress& address, const bus::SerialLine& line) {
  const Result<void> is_willing = check_willing(address);
  if (!is_willing.has_value()) return tl::unexpected(is_willing.error());
  Result<std::unique_ptr<bus::SerialPort>> port = buses_->open_serial(address, line);
  if (!port.has_value()) return port;
  const Cable& cable = cables_[address];
  return std::make_unique<FaultySerial>(std::move(port.value()), *clock_, cable.plan, cable.tally);
}

}  // namespace thimble::sim
