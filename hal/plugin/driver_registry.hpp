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
  [[nodiscard]] const std::vector<std::unique_ptr<Driver>>& drivers() const noexcept {
    return drivers_;
  }
  // The first driver that says "mine". NotFound when all say NotMine; any other error of a
  // probe is returned at once, with the driver's name in front.
  [[nodiscard]] Result<const Driver*> match(const bus::BusDeviceInfo& info,
                                            const DriverSettings& settings) const;

 private:
  std::vector<std::unique_ptr<Driver>> drivers_;
};

}  // namespace thimble::plugin
