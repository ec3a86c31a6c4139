#pragma once

#include "hal/base/result.hpp"
#include "sim/export/simdev/options.hpp"

namespace thimble::sim {

// Offers the device until SIGTERM or SIGINT. Thread: the main one. Not RT.
// Errors: InvalidArgument where the options are a mistake: an unknown model, or none of the ways,
// or one by which that model cannot be offered; Permission and System from the kernel.
[[nodiscard]] Result<void> run_simdev(const SimdevOptions& options);

}  // namespace thimble::sim
