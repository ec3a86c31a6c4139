#pragma once

#include <memory>

#include "hal/plugin/driver.hpp"

namespace thimble::falcon {

// Finds Novint Falcons on USB and opens them as FalconDevice.
//
// probe(): NotMine for other ids, buses and pipes; InvalidArgument for another model's name and for
// a scale that cannot be. The ids are the Falcon's alone, so a person need not name it.
// open(): reads the firmware's file, if the settings name one, with the errors of load_image();
// what it opens has sent nothing yet, and boots between the ticks (boot_sequence.hpp). Without
// DriverSettings::clock a pipe on which nothing comes is never noticed, for time is that of the
// packets alone. It waits for the kernel, perhaps for seconds.
//
// Thread: making it, any; its calls as plugin::Driver, any non-RT thread, several at once.
[[nodiscard]] std::unique_ptr<plugin::Driver> make_falcon_driver();

}  // namespace thimble::falcon
