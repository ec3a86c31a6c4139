#pragma once

#include <cstdint>

#include "hal/base/result.hpp"
#include "lab/findings/findings.hpp"

namespace thimble::lab {

struct ConstraintModelsSettings {
  std::uint64_t seed{1};
};

// The thesis's figures 3-7 to 3-10 played: a hand at 0.1 m/s through a cell, out of its side, past
// it, along two, and into corners of 45, 90 and 135 degrees; what holds it by the simple model, by
// a ghost point in cells, and by a god-object that the planes of shapes and of a field hold. Then
// jumps of a hand in corners of any angle. Criteria: every proxy is where its planes allow, planes
// push only what touches them, no ghost is in matter, and at the stages of the figures as many
// planes hold as they draw, the simple model's fault included. Deterministic by seed; no delay.
// Errors: a world's, which these have not.
[[nodiscard]] Result<Findings> run_constraint_models(const ConstraintModelsSettings& settings);

}  // namespace thimble::lab
