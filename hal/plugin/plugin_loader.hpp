#pragma once

#include <string>
#include <vector>

#include "hal/base/result.hpp"
#include "hal/plugin/driver_registry.hpp"
#include "hal/plugin/plugin_abi.h"
#include "hal/plugin/sim_model.hpp"

namespace thimble::plugin {

// Loads the shared object at an absolute path and looks at its descriptor. Its code runs with the
// rights of this process from then on, and it stays for as long as the process lives, refused or
// not: code that was unloaded could still be called.
//
// The libraries that it brings must be as trusted as itself, but are looked at only once they are
// mapped: what they do on being loaded is done by then.
//
// Thread: control thread, while no servo runs.
// Errors: those of trusted_plugin_path() and check_plugin(), or Malformed; one sentence with the
// path in front.
[[nodiscard]] Result<const thimble_plugin*> load_plugin(const std::string& path);

// Adds what a plugin brings; a driver with the name of one of the house takes that one's place.
// InvalidArgument, and nothing is added, when a model has its name already, or a driver from
// outside.
[[nodiscard]] Result<void> register_plugin(const thimble_plugin& plugin, DriverRegistry& drivers,
                                           SimModelRegistry& models);

}  // namespace thimble::plugin
