#pragma once

#include <cstddef>

#include "hal/device/haptic_device.hpp"
#include "hal/plugin/plugin_abi.h"
#include "hal/rt/annotations.hpp"

namespace thimble::plugin {

// From a plugin's sample, which is sound, to a state; its time and number are another's to say. RT.
THIMBLE_RT void copy_sample(const thimble_sample& sample, std::size_t joints,
                            HapticState& out) noexcept;
// Takes DONE for NEEDS_PERSON as long as `is_doubted`, until a sample does not say it. Were the old
// reference taken again at once, the servo would never learn that zero was sent meanwhile: its
// limiter would go on from a force that the arm no longer has, in one step. RT.
THIMBLE_RT void doubt_calibration(thimble_sample& sample, bool& is_doubted) noexcept;

}  // namespace thimble::plugin
