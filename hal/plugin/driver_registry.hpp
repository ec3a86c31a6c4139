#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "hal/plugin/driver.hpp"

namespace thimble::plugin {

// The drivers this daemon knows, in the order in which they are asked.
// Thread: adding, the control thread before any arm; the rest any. Ownership: owns the drivers.
class DriverRegistry {
 public:
  void add(std::unique_ptr<Driver> driver);
  // One that a person named: in the place of the driver of the house that has its name, so that it
  // is asked when that one was; else after all others.
  void add_from_outside(std::unique_ptr<Driver> driver);
  [[nodiscard]] bool is_from_outside(std::string_view name) const noexcept;
  [[nodiscard]] const std::vector<std::unique_ptr<Driver>>& drivers() const noexcept {
    return drivers_;
  }
  // The first driver that says "mine". NotFound when all say NotMine, with what they say against
  // it; any other error of a probe is returned at once, with the driver's name in front.
  [[nodiscard]] Result<const Driver*> match(const bus::BusDeviceInfo& info,
                                            const DriverSettings& settings) const;
  // Whether a driver calls it its own: what it lacks in a configuration, such as the full scale of
  // its amplifier, makes it no less an arm.
  [[nodiscard]] bool knows(const bus::BusDeviceInfo& info) const;
  // What drivers whose ids it has say against a device that none takes, each with its name; empty:
  // its ids are nobody's.
  [[nodiscard]] std::string objections(const bus::BusDeviceInfo& info) const;

 private:
  std::vector<std::unique_ptr<Driver>> drivers_;
  std::vector<const Driver*> from_outside_;  // of those
};

}  // namespace thimble::plugin
