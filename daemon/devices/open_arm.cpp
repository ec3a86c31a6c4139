#include "daemon/devices/open_arm.hpp"

#include <string>
#include <utility>

namespace thimble::devices {

Result<bus::BusDeviceInfo> find_device(bus::BusEnumerator& buses,
                                       const bus::DeviceAddress& address) {
  std::string there;
  for (bus::BusDeviceInfo& device : buses.list()) {
    if (device.address == address) return std::move(device);
    there += " " + device.address.text;
  }
  return fail(Errc::NotFound,
              "no device at " + address.text +
                  (there.empty() ? "; none is plugged in" : "; there are:" + there));
}

Result<std::unique_ptr<HapticDevice>> open_found(bus::BusEnumerator& buses,
                                                 const plugin::DriverRegistry& drivers,
                                                 const bus::BusDeviceInfo& found,
                                                 const plugin::DriverSettings& settings) {
  const Result<const plugin::Driver*> driver = drivers.match(found, settings);
  if (!driver) return tl::unexpected(driver.error());
  Result<std::unique_ptr<HapticDevice>> device = (*driver)->open(buses, found, settings);
  if (!device) return tl::unexpected(device.error().in((*driver)->name()).in(found.address.text));
  return device;
}

Result<std::unique_ptr<HapticDevice>> open_arm(bus::BusEnumerator& buses,
                                               const plugin::DriverRegistry& drivers,
                                               const bus::DeviceAddress& address,
                                               const plugin::DriverSettings& settings) {
  const Result<bus::BusDeviceInfo> found = find_device(buses, address);
  if (!found) return tl::unexpected(found.error());
  return open_found(buses, drivers, *found, settings);
}

}  // namespace thimble::devices
