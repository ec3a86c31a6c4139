#pragma once

#include <string>
#include <vector>

#include "hal/base/result.hpp"
#include "hal/plugin/driver_registry.hpp"
#include "hal/plugin/sim_model.hpp"

namespace thimble::session {

// Every driver and every simulated model that the daemon knows, and the command line lists.
// Thread: control thread. Ownership: must outlive the sessions that use them.
struct Plugins {
  Plugins();

  // Loads each shared object and adds what it brings; see plugin::load_plugin(). What could not be
  // had, one sentence each that begins with the path.
  [[nodiscard]] std::vector<Error> load(const std::vector<std::string>& paths);

  plugin::DriverRegistry drivers;
  plugin::SimModelRegistry models;
};

}  // namespace thimble::session
