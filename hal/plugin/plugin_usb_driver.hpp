#pragma once

#include <memory>

#include "hal/plugin/driver.hpp"
#include "hal/plugin/plugin_abi.h"

namespace thimble::plugin {

// As make_plugin_driver(), of bare USB devices. The plugin talks to its pipes itself, through
// functions that never wait; samples and capabilities are judged as those of HID plugins are, and
// zero is asked for until the arm is calibrated.
// Thread: making it, any; its calls as Driver. Not RT. Ownership: `driver` is the plugin's own and
// lasts as long as the process. Errors: as Driver, with the plugin's reason.
[[nodiscard]] std::unique_ptr<Driver> make_plugin_usb_driver(const thimble_usb_driver& driver);

}  // namespace thimble::plugin
