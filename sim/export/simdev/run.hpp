#pragma once

#include "hal/base/result.hpp"
#include "sim/export/simdev/options.hpp"

namespace thimble::sim {

// Offers the device until SIGTERM or SIGINT. Thread: the main one. Not RT.
// Errors: NotFound for an unknown model, InvalidArgument for one that cannot be offered that way,
// Permission and System from the kernel.
[[nodiscard]] Result<void> run_simdev(const SimdevOptions& options);

}  // namespace thimble::sim
