#pragma once

#include "hal/plugin/sim_model.hpp"

namespace thimble::sim {

// Adds every arm of all_arm_parameters() under its name. SimModelSettings: amplifier_max_a 0 means
// the board as its source builds it (3 A); a negative, non-finite or > 32.767 A value is
// InvalidArgument. The seed sets the phase of the board's PWM against the bus's frames.
// Thread: control thread. Not RT.
void register_arm_models(plugin::SimModelRegistry& registry);

}  // namespace thimble::sim
