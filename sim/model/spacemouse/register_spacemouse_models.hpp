#pragma once

#include "hal/plugin/sim_model.hpp"

namespace thimble::sim {

// Adds "spacemouse" (combined layout) and "spacenavigator" (separate layout). No settings.
// Thread: control thread. Not RT.
void register_spacemouse_models(plugin::SimModelRegistry& registry);

}  // namespace thimble::sim
