#pragma once

#include "hal/plugin/driver_registry.hpp"
#include "hal/plugin/sim_model.hpp"

namespace thimble::session {

// Every driver and every simulated model that the daemon knows, and the command line lists.
// Thread: control plane. Ownership: must outlive the sessions that use them.
struct Plugins {
  Plugins();

  plugin::DriverRegistry drivers;
  plugin::SimModelRegistry models;
};

}  // namespace thimble::session
