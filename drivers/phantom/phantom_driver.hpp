#pragma once

#include <memory>

#include "hal/plugin/driver.hpp"

namespace thimble::phantom {

// Finds the family's controllers on HID, and on a serial port those that speak text, and opens
// them as PhantomDevice.
//
// probe(): NotMine for other ids, buses and report lengths. The ids are shared by the world, so
// a device that is neither simulated nor named by the configuration is refused: Permission.
// InvalidArgument when the amplifier's full scale or the model is missing or wrong. A simulated
// device ("sim:NAME") is of the model NAME unless the settings say otherwise.
// open(): the same errors, those of the bus, and InvalidArgument for an arm that speaks text
// without DriverSettings::clock. It waits for the kernel, perhaps for seconds, and sends nothing.
//
// Thread: making it, any; its calls as plugin::Driver, any non-RT thread, several at once.
[[nodiscard]] std::unique_ptr<plugin::Driver> make_phantom_driver();

}  // namespace thimble::phantom
