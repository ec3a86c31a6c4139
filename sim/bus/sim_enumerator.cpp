#include "sim/bus/sim_enumerator.hpp"

#include <string>
#include <utility>
#include <variant>

#include "sim/bus/sim_hid_port.hpp"
#include "sim/bus/sim_serial_port.hpp"
#include "sim/bus/sim_usb_port.hpp"

namespace thimble::sim {

using bus::BusEvent;
using bus::DeviceAddress;

namespace {

// USB 2.0, 5.7.3 and 5.8.3: interrupt and bulk at full speed.
constexpr std::size_t kMaxFullSpeedPacketBytes = 64;

}  // namespace

Result<void> SimEnumerator::check_new(const DeviceAddress& address, bool has_model) const {
  if (ports_.find(address) != ports_.end()) return fail(Errc::Busy, address.text + " is taken");
  if (!has_model) return fail(Errc::InvalidArgument, address.text + ": no model");
  return {};
}

void SimEnumerator::add(std::unique_ptr<SimPort> port) {
  events_.push_back({BusEvent::Kind::Arrived, port->info()});
  const DeviceAddress address = port->info().address;
  ++pluggings_[address];
  ports_.emplace(address, std::move(port));
}

Result<void> SimEnumerator::plug(const DeviceAddress& address,
                                 std::unique_ptr<plugin::SimHidModel> model) {
  Result<void> is_new = check_new(address, model != nullptr);
  if (!is_new.has_value()) return is_new;
  if (model->frame_period() <= Duration(0)) {
    return fail(Errc::InvalidArgument, address.text + ": the model has no frame period");
  }
  const bus::BusDeviceInfo info = model->describe();
  if (info.input_report_bytes > bus::kMaxHidReportBytes ||
      info.output_report_bytes > bus::kMaxHidReportBytes) {
    return fail(Errc::InvalidArgument, address.text + ": reports are at most 64 bytes long");
  }
  add(std::make_unique<SimHidPort>(*clock_, address, std::move(model)));
  return {};
}

Result<void> SimEnumerator::plug(const DeviceAddress& address,
                                 std::unique_ptr<plugin::SimUsbModel> model) {
  Result<void> is_new = check_new(address, model != nullptr);
  if (!is_new.has_value()) return is_new;
  for (const bus::UsbEndpointInfo& endpoint : model->describe().endpoints) {
    if (endpoint.max_packet_bytes <= kMaxFullSpeedPacketBytes) continue;
    return fail(Errc::InvalidArgument, address.text + ": packets are at most 64 bytes long");
  }
  add(std::make_unique<SimUsbPort>(*clock_, address, std::move(model)));
  return {};
}

Result<void> SimEnumerator::plug(const DeviceAddress& address,
                                 std::unique_ptr<plugin::SimSerialModel> model) {
  Result<void> is_new = check_new(address, model != nullptr);
  if (!is_new.has_value()) return is_new;
  add(std::make_unique<SimSerialPort>(*clock_, address, std::move(model)));
  return {};
}

Result<void> SimEnumerator::plug_any(const DeviceAddress& address, plugin::SimModel model) {
  return std::visit([&](auto& device) { return plug(address, std::move(device)); }, model);
}

Result<void> SimEnumerator::unplug(const DeviceAddress& address, Supply supply) {
  SimPort* port = find(address);
  const bool was_plugged = port != nullptr && port->is_plugged();
  if (port == nullptr || !port->unplug(supply)) {
    return fail(Errc::NotFound, address.text + " is not plugged in");
  }
  if (was_plugged) events_.push_back({BusEvent::Kind::Left, port->info()});
  return {};
}

Result<void> SimEnumerator::replug(const DeviceAddress& address) {
  SimPort* port = find(address);
  if (port == nullptr || !port->replug()) {
    return fail(Errc::NotFound, address.text + " is not an unplugged device");
  }
  ++pluggings_[address];
  events_.push_back({BusEvent::Kind::Arrived, port->info()});
  return {};
}

bus::BusDeviceInfo SimEnumerator::describe(const SimPort& port) const {
  bus::BusDeviceInfo info = port.info();
  info.address.plugging = std::to_string(pluggings_.at(info.address));
  return info;
}

std::vector<bus::BusDeviceInfo> SimEnumerator::list() {
  std::vector<bus::BusDeviceInfo> devices;
  for (const auto& [address, port] : ports_) {
    if (port->is_plugged()) devices.push_back(describe(*port));
  }
  return devices;
}

std::optional<BusEvent> SimEnumerator::poll_event() {
  if (events_.empty()) return std::nullopt;
  BusEvent event = std::move(events_.front());
  events_.pop_front();
  return event;
}

Result<std::unique_ptr<bus::HidDevice>> SimEnumerator::open_hid(const DeviceAddress& address) {
  SimPort* port = find(address);
  if (port == nullptr) return fail(Errc::NotFound, "no device at " + address.text);
  return port->open_hid();
}

Result<std::unique_ptr<bus::UsbDevice>> SimEnumerator::open_usb(const DeviceAddress& address,
                                                                const bus::UsbClaim& claim) {
  SimPort* port = find(address);
  if (port == nullptr) return fail(Errc::NotFound, "no device at " + address.text);
  return port->open_usb(claim);
}

Result<std::unique_ptr<bus::SerialPort>> SimEnumerator::open_serial(const DeviceAddress& address,
                                                                    const bus::SerialLine& line) {
  SimPort* port = find(address);
  if (port == nullptr) return fail(Errc::NotFound, "no device at " + address.text);
  return port->open_serial(line);
}

plugin::ArmBackend* SimEnumerator::arm_backend(const DeviceAddress& address) noexcept {
  SimPort* port = find(address);
  return port == nullptr ? nullptr : port->arm_backend();
}

SimPort* SimEnumerator::find(const DeviceAddress& address) noexcept {
  const auto found = ports_.find(address);
  if (found == ports_.end()) return nullptr;
  const bool is_as_listed =
      address.plugging.empty() || address.plugging == std::to_string(pluggings_.at(address));
  return is_as_listed ? found->second.get() : nullptr;
}

}  // namespace thimble::sim
