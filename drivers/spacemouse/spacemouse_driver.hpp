#pragma once

#include <memory>

#include "hal/plugin/driver.hpp"

namespace thimble::spacemouse {

// Finds 3Dconnexion's pucks on HID and opens them as SpaceMouseDevice.
//
// probe(): NotMine for other ids and buses, and for devices that do not number their reports;
// InvalidArgument where the settings name another model than this puck's or "spacemouse", any. The
// ids are 3Dconnexion's own and nothing is sent, so no device need be named.
// open() wants DriverSettings::clock: InvalidArgument without it.
//
// Thread: making it, any; its calls as plugin::Driver, any non-RT thread, several at once.
[[nodiscard]] std::unique_ptr<plugin::Driver> make_spacemouse_driver();

}  // namespace thimble::spacemouse
