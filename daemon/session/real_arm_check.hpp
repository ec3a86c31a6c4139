#pragma once

#include <string>
#include <vector>

#include "daemon/config/config.hpp"
#include "hal/plugin/driver_registry.hpp"

namespace thimble::session {

// A key of an arm's table, and what is wrong there, in words for a person.
struct KeyRefusal {
  std::string key;
  std::string message;
};

// What can be known of a real arm before anybody looks for it: that no bus names a device so, that
// its model hangs on another bus, that a key does nothing there. Nothing where a driver that may be
// meant cannot tell, as those of plugins; nothing of a simulated arm, which an override makes of
// any: what it is told in vain keeps nobody's hand.
// Thread: any. Not RT. Errors: none but the list.
[[nodiscard]] std::vector<KeyRefusal> refusals_of_real(const config::ArmConfig& arm,
                                                       const plugin::DriverRegistry& drivers);

}  // namespace thimble::session
