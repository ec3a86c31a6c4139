#include "hal/plugin/driver_registry.hpp"

#include <utility>

namespace thimble::plugin {

void DriverRegistry::add(std::unique_ptr<Driver> driver) { drivers_.push_back(std::move(driver)); }

Result<const Driver*> DriverRegistry::match(const bus::BusDeviceInfo& info,
                                            const DriverSettings& settings) const {
  for (const auto& driver : drivers_) {
    const Result<void> probed = driver->probe(info, settings);
    if (probed) return driver.get();
    if (probed.error().code != Errc::NotMine) {
      return tl::unexpected(probed.error().in(driver->name()));
    }
  }
  return fail(Errc::NotFound, "no driver knows the device at " + info.address.text);
}

}  // namespace thimble::plugin
