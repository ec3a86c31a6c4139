#include "daemon/devices/arm_opener.hpp"

#include <algorithm>
#include <vector>

namespace thimble::devices {

std::optional<bus::BusDeviceInfo> find_device(bus::BusEnumerator& buses,
                                              const bus::DeviceAddress& address) {
  for (const bus::BusDeviceInfo& device : buses.list()) {
    if (device.address == address) return device;
  }
  return std::nullopt;
}

Result<std::unique_ptr<HapticDevice>> open_arm(bus::BusEnumerator& buses,
                                               const plugin::DriverRegistry& drivers,
                                               const bus::DeviceAddress& address,
                                               const plugin::DriverSettings& settings) {
  const std::vector<bus::BusDeviceInfo> present = buses.list();
  const auto found = std::find_if(present.begin(), present.end(),
                                  [&](const auto& device) { return device.address == address; });
  if (found == present.end()) {
    std::string there;
    for (const bus::BusDeviceInfo& device : present) there += " " + device.address.text;
    return fail(Errc::NotFound,
                "no device at " + address.text +
                    (there.empty() ? "; none is plugged in" : "; there are:" + there));
  }
  const Result<const plugin::Driver*> driver = drivers.match(*found, settings);
  if (!driver) return tl::unexpected(driver.error());
  Result<std::unique_ptr<HapticDevice>> device = (*driver)->open(buses, *found, settings);
  if (!device) return tl::unexpected(device.error().in((*driver)->name()).in(address.text));
  return device;
}

}  // namespace thimble::devices
