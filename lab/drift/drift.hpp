#pragma once

#include <cstdint>

#include "hal/base/result.hpp"
#include "lab/findings/findings.hpp"
#include "lab/trial/parallel.hpp"

namespace thimble::lab {

struct DriftSettings {
  std::uint64_t seed{1};  // kept with what was found; nothing here is random
  Progress progress{};
};

// Taps at 0.25 to 4 a second through the ghost point, streamed and in lock-step, and constraint
// planes with either way of late walls: the offset of the frame tap by tap, how fast it gets away,
// and from how many taps a second on, beside tap_theory(). Deterministic; takes a second. Errors:
// the first run's that failed.
[[nodiscard]] Result<Findings> run_drift(const DriftSettings& settings);

}  // namespace thimble::lab
