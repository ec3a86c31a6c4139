#include "sim/fault/faulty_enumerator.hpp"

#include <utility>

namespace thimble::sim {

void FaultyEnumerator::set_plan(const bus::DeviceAddress& address, FaultPlan plan) {
  cables_[address].plan = std::move(plan);
}

FaultCounts FaultyEnumerator::injected(const bus::DeviceAddress& address) const {
  const auto cable = cables_.find(address);
  return cable == cables_.end() ? FaultCounts{} : cable->second.tally->read();
}

Result<std::unique_ptr<bus::HidDevice>> FaultyEnumerator::open_hid(
    const bus::DeviceAddress& address) {
  Result<std::unique_ptr<bus::HidDevice>> device = buses_->open_hid(address);
  if (!device.has_value()) return device;
  const Cable& cable = cables_[address];
  return std::make_unique<FaultyHid>(std::move(device.value()), *clock_, cable.plan, cable.tally);
}

}  // namespace thimble::sim
