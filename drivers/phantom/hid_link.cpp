#include "drivers/phantom/hid_link.hpp"

#include <utility>

namespace thimble::phantom {

HidLink::HidLink(std::unique_ptr<bus::HidDevice> bus, ReportForm form) noexcept
    : bus_(std::move(bus)), form_(form) {}

IoStatus HidLink::read(ControllerReport& out) noexcept {
  const IoStatus status = bus_->read_newest(report_);
  if (status != IoStatus::Ok) return status;
  const auto parsed = parse_device_report(report_.payload(), form_);
  if (!parsed) {
    malformed_.fetch_add(1, std::memory_order_relaxed);
    return IoStatus::ProtocolError;
  }
  out = {*parsed, report_.arrived_at, report_.sequence};
  return IoStatus::Ok;
}

IoStatus HidLink::write_currents(const std::array<double, 3>& current_a) noexcept {
  return bus_->submit(encode_currents(current_a, form_).payload());
}

IoStatus HidLink::zero_counters() noexcept {
  return bus_->submit(encode_zero_counters(form_).payload());
}

ZeroCommand HidLink::zero_command() const noexcept {
  ZeroCommand zero;
  const HostReport report = encode_currents({}, form_);
  for (const std::uint8_t byte : report.payload()) zero.bytes.push_back(byte);
  return zero;
}

DeviceCounters HidLink::counters() const noexcept {
  const bus::HidCounters on_bus = bus_->counters();
  DeviceCounters counters;
  counters.reports_in = on_bus.reports_in;
  counters.reports_skipped = on_bus.reports_skipped;
  counters.malformed = malformed_.load(std::memory_order_relaxed);
  counters.commands_out = on_bus.reports_out;
  counters.commands_superseded = on_bus.writes_superseded;
  return counters;
}

}  // namespace thimble::phantom
