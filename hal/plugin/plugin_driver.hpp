#pragma once

#include <memory>

#include "hal/plugin/driver.hpp"
#include "hal/plugin/plugin_abi.h"

namespace thimble::plugin {

// The driver of a plugin as the house knows drivers, and its devices as HapticDevice.
//
// The host does the talking: it hands reports in, sends what comes out, says when a sample was
// measured and whether one is new, and asks for zero until the arm is calibrated. A real device is
// opened only when the configuration names it. Numbers that no arm can have, as samples or as
// capabilities, are refused: ProtocolError (counted as malformed) or Malformed.
//
// `driver` has passed check_plugin() and lasts as long as the process.
// Thread, RT: as Driver and HapticDevice; no allocation after opening, but what the plugin does.
[[nodiscard]] std::unique_ptr<Driver> make_plugin_driver(const thimble_driver& driver);

}  // namespace thimble::plugin
