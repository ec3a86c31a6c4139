#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "hal/plugin/driver.hpp"

namespace thimble::plugin {

// The drivers this daemon knows, in the order in which they are asked.
// Thread: control plane. Ownership: owns the drivers.
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
  // The first driver that says "mine". NotFound when all say NotMine; any other error of a
  // probe is returned at once, with the driver's name in front.
  [[nodiscard]] Result<const Driver*> match(const bus::BusDeviceInfo& info,
                                            const DriverSettings& settings) const;

 private:
  std::vector<std::unique_ptr<Driver>> drivers_;
  std::vector<const Driver*> from_outside_;  // of those
};

}  // namespace thimble::plugin
