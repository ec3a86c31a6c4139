#pragma once

#include <vector>

#include "lab/trial/coupling_case.hpp"

namespace thimble::lab {

// The schemes that are compared, each with the settings that it ships with; of waves also those of
// a pencil and of a heavy drill (teleop.md 3).
[[nodiscard]] std::vector<CouplingCase> compared_schemes();

// Shown and ranked in the same tables, and of no criterion (decision 0478): of scheme f the other
// way to a late wall, of d the zone that names faces, and the printed client of e, in lock-step as
// it is printed.
[[nodiscard]] std::vector<CouplingCase> schemes_beside();

// The one that others are measured beside: the ghost point, streamed, at no delay.
[[nodiscard]] CouplingCase reference_scheme();

}  // namespace thimble::lab
