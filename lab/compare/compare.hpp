#pragma once

#include <cstdint>

#include "hal/base/result.hpp"
#include "lab/findings/findings.hpp"
#include "lab/trial/coupling_case.hpp"
#include "lab/trial/parallel.hpp"

namespace thimble::lab {

struct CompareSettings {
  bool moves{false};         // the wall's front, to and fro
  Guard guard{Guard::None};  // of each scheme that can have it
  std::uint64_t seed{1};
  Progress progress{};
};

// Every scheme at 1 to 500 ms on four networks, in the scenarios of measures.hpp, ranked at each
// delay by ranking.hpp; with equal weights and each metric left out in turn beside it.
// Deterministic by seed; takes a minute. Errors: a scheme refuses the world.
[[nodiscard]] Result<Findings> run_compare(const CompareSettings& settings);

}  // namespace thimble::lab
