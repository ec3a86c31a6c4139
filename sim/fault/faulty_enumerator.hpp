#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "hal/base/time.hpp"
#include "hal/bus/bus_enumerator.hpp"
#include "sim/fault/fault_plan.hpp"
#include "sim/fault/faulty_hid.hpp"
#include "sim/fault/faulty_serial.hpp"
#include "sim/fault/faulty_usb.hpp"

namespace thimble::sim {

// Any bus whose devices sit behind bad cables: what is opened through it is a FaultyHid,
// a FaultyUsb or a FaultySerial.
//
// Thread: as BusEnumerator. Ownership: the bus below and the clock must outlive it.
// Errors: as the bus below. An injected Disconnect is known to the handle only: no device
// leaves list() by it. RefuseOpen is Busy.
// Counted: DelayEvents once for each event that a window kept back, at the address of its plan.
class FaultyEnumerator final : public bus::BusEnumerator {
 public:
  FaultyEnumerator(bus::BusEnumerator& buses, const Clock& clock) noexcept
      : buses_(&buses), clock_(&clock) {}

  // For every handle opened from now on at this address, for opening it and for its events; without
  // a plan nothing goes wrong.
  void set_plan(const bus::DeviceAddress& address, FaultPlan plan);
  // Of all handles ever opened at this address.
  [[nodiscard]] FaultCounts injected(const bus::DeviceAddress& address) const;

  [[nodiscard]] std::vector<bus::BusDeviceInfo> list() override { return buses_->list(); }
  [[nodiscard]] std::optional<bus::BusEvent> poll_event() override;
  [[nodiscard]] Result<std::unique_ptr<bus::HidDevice>> open_hid(
      const bus::DeviceAddress& address) override;
  [[nodiscard]] Result<std::unique_ptr<bus::UsbDevice>> open_usb(
      const bus::DeviceAddress& address, const bus::UsbClaim& claim) override;
  [[nodiscard]] Result<std::unique_ptr<bus::SerialPort>> open_serial(
      const bus::DeviceAddress& address, const bus::SerialLine& line) override;

 private:
  struct Cable {
    FaultPlan plan;
    std::shared_ptr<FaultTally> tally = std::make_shared<FaultTally>();
  };

  [[nodiscard]] Result<void> check_willing(const bus::DeviceAddress& address);
  [[nodiscard]] bool is_on(const Cable& cable, FaultKind kind) const noexcept;
  // Whether events are kept back now; keeps those that there are.
  [[nodiscard]] bool is_delaying();
  [[nodiscard]] std::optional<bus::BusEvent> next_event();

  bus::BusEnumerator* buses_;
  const Clock* clock_;
  std::map<bus::DeviceAddress, Cable> cables_;
  std::deque<bus::BusEvent> late_;  // kept back, in their order
};

}  // namespace thimble::sim
