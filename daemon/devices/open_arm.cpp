#include "daemon/devices/open_arm.hpp"

#include <optional>
#include <string>
#include <utility>

namespace thimble::devices {

namespace {

// Whether ports were addresses until decision 0507, and this one's was that.
bool was_called(const bus::BusDeviceInfo& device, const bus::DeviceAddress& address) {
  return !device.port.empty() &&
         address.text == std::string(bus::to_string(device.kind)) + ":" + device.port;
}

}  // namespace

Result<bus::BusDeviceInfo> find_device(bus::BusEnumerator& buses,
                                       const bus::DeviceAddress& address) {
  std::string there;
  std::string in_that_port;
  std::optional<bus::BusDeviceInfo> found;
  for (bus::BusDeviceInfo& device : buses.list()) {
    there += " " + device.address.text;
    if (was_called(device, address)) {
      in_that_port = "; what the kernel calls so today is: " + device.address.text +
                     ", which may be another device than the one that was meant";
    }
    if (device.address != address) continue;
    // No bus gives such a list; should one, then neither is driven with what is known of the other.
    if (found) return fail(Errc::Busy, "two devices are called " + address.text);
    found = std::move(device);
  }
  if (found) return *std::move(found);
  return fail(Errc::NotFound,
              "no device at " + address.text + in_that_port +
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
