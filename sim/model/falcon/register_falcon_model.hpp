#pragma once

#include "hal/plugin/sim_model.hpp"

namespace thimble::sim {

// Adds the Falcon twice: as "falcon", with nothing in its memory, as it is after power-up; and as
// "falcon-loaded", to which somebody has brought the firmware before, as who has no image needs it.
// It, too, forgets with its power. Of SimModelSettings neither member has a meaning: it has no
// amplifier to set, and nothing in it is left to chance.
// Thread: control thread. Not RT.
void register_falcon_model(plugin::SimModelRegistry& registry);

}  // namespace thimble::sim
