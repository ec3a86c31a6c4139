#pragma once

#include "hal/plugin/sim_model.hpp"

namespace thimble::sim {

// Adds the Falcon as "falcon". Of SimModelSettings neither member has a meaning: it has no
// amplifier to set, and nothing in it is left to chance. Thread: control plane. Not RT.
void register_falcon_model(plugin::SimModelRegistry& registry);

}  // namespace thimble::sim
