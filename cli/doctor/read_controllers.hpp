#pragma once

#include <vector>

#include "cli/doctor/facts.hpp"
#include "cli/doctor/file_tree.hpp"
#include "hal/plugin/driver_registry.hpp"

namespace thimble::doctor {

// The arms that are plugged in, by the drivers' passive probes, who shall see what the real buses
// would show them: HID devices by their hidraw nodes, terminals on USB by theirs, then USB devices
// by their descriptors, as far as sysfs has them. Holders are not looked for. Thread: any. Not RT.
[[nodiscard]] std::vector<Controller> read_controllers(const FileTree& tree,
                                                       const plugin::DriverRegistry& drivers);

}  // namespace thimble::doctor
