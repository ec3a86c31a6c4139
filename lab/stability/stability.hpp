#pragma once

#include <cstdint>

#include "hal/base/result.hpp"
#include "lab/findings/findings.hpp"
#include "lab/trial/parallel.hpp"

namespace thimble::lab {

struct StabilitySettings {
  std::uint64_t seed{1};  // kept with what was found; nothing here is random
  Progress progress{};
};

// The largest stable stiffness of each scheme at 1 to 500 ms, beside its theory (theory.hpp); the
// criteria are those of teleop.md section 2, (a) to (c) and (e). Deterministic; takes half a
// minute. Errors: the first trial's that failed.
[[nodiscard]] Result<Findings> run_stability(const StabilitySettings& settings);

}  // namespace thimble::lab
