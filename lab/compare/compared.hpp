#pragma once

#include <vector>

#include "lab/trial/coupling_case.hpp"

namespace thimble::lab {

// The schemes that are compared, each with the settings that it ships with; of waves also those of
// a pencil and of a heavy drill (teleop.md 3).
[[nodiscard]] std::vector<CouplingCase> compared_schemes();

// The one that others are measured beside: the ghost point, streamed, at no delay.
[[nodiscard]] CouplingCase reference_scheme();

}  // namespace thimble::lab
