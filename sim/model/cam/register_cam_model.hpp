#pragma once

#include "hal/plugin/sim_model.hpp"

namespace thimble::sim {

// Adds "cam-8": eight modules of 2^16 sites at 25 MHz, on USB; for who offers it to a kernel, whose
// bus is run by a thread that drives no arm. No settings. Thread: control plane. Not RT.
void register_cam_model(plugin::SimModelRegistry& registry);

}  // namespace thimble::sim
