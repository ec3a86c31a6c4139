#pragma once

#include "hal/plugin/plugin_abi.h"
#include "hal/plugin/sim_model.hpp"

namespace thimble::plugin {

// The simulated arm of a plugin as the house knows models. What it says of itself is checked when
// one is made: Malformed. Later, numbers that are not finite count as zero, and a step of the plant
// that the contract forbids is answered by no force of the hand.
//
// `model` has passed check_plugin() and lasts as long as the process.
// Thread, RT: as SimHidModel and ArmBackend; no allocation after it is made, but what the plugin
// does.
[[nodiscard]] SimModelEntry plugin_model_entry(const thimble_model& model);

}  // namespace thimble::plugin
