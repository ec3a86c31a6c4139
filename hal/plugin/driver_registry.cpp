#include "hal/plugin/driver_registry.hpp"

#include <algorithm>
#include <utility>

namespace thimble::plugin {

void DriverRegistry::add(std::unique_ptr<Driver> driver) { drivers_.push_back(std::move(driver)); }

void DriverRegistry::add_from_outside(std::unique_ptr<Driver> driver) {
  const auto known = std::find_if(drivers_.begin(), drivers_.end(), [&](const auto& other) {
    return other->name() == driver->name() && !is_from_outside(other->name());
  });
  from_outside_.push_back(driver.get());
  if (known == drivers_.end()) return add(std::move(driver));
  *known = std::move(driver);
}

bool DriverRegistry::is_from_outside(std::string_view name) const noexcept {
  return std::any_of(from_outside_.begin(), from_outside_.end(),
                     [&](const Driver* driver) { return driver->name() == name; });
}

Result<const Driver*> DriverRegistry::match(const bus::BusDeviceInfo& info,
                                            const DriverSettings& settings) const {
  for (const auto& driver : drivers_) {
    const Result<void> probed = driver->probe(info, settings);
    if (probed) return driver.get();
    if (probed.error().code != Errc::NotMine) {
      return tl::unexpected(probed.error().in(driver->name()));
    }
  }
  const std::string why = objections(info);
  return fail(Errc::NotFound, "no driver knows the device at " + info.address.text +
                                  (why.empty() ? "" : ": " + why));
}

bool DriverRegistry::knows(const bus::BusDeviceInfo& info) const {
  DriverSettings settings;
  settings.is_named_by_person = true;
  return std::any_of(drivers_.begin(), drivers_.end(), [&](const auto& driver) {
    const Result<void> probed = driver->probe(info, settings);
    return probed || probed.error().code != Errc::NotMine;
  });
}

std::string DriverRegistry::objections(const bus::BusDeviceInfo& info) const {
  DriverSettings settings;
  settings.is_named_by_person = true;
  std::string all;
  for (const auto& driver : drivers_) {
    const Result<void> probed = driver->probe(info, settings);
    if (probed || probed.error().code != Errc::NotMine || probed.error().message.empty()) continue;
    all += (all.empty() ? "" : "; ") + probed.error().in(driver->name()).message;
  }
  return all;
}

}  // namespace thimble::plugin
