#pragma once

#include <cstdint>

#include "hal/base/result.hpp"
#include "lab/findings/findings.hpp"
#include "lab/trial/parallel.hpp"

namespace thimble::lab {

struct HelloSphereSettings {
  std::uint64_t seed{1};  // kept with what was found; nothing here is random
  Progress progress{};
};

// The ball of thesis 3.2, pressed and stroked through each scheme that can feel it, at 1 to 200 ms:
// how much the finger swings, what it is given, and how far its way over the ball is from that
// without delay. The criteria say that the remote closed loop swings and the others do not.
// Deterministic; takes a second. Errors: the first touch's that failed.
[[nodiscard]] Result<Findings> run_hello_sphere(const HelloSphereSettings& settings);

}  // namespace thimble::lab
