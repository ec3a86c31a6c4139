#pragma once

#include <cstdint>

#include "hal/base/result.hpp"
#include "lab/findings/findings.hpp"
#include "lab/trial/parallel.hpp"

namespace thimble::lab {

// Two arms that are coupled to each other (thesis 5.3.5), by each pair of schemes there is, at 1 to
// 500 ms to the other arm and back, on a good and on a bad network, and on two hosts with our own
// datagrams between them. Two courses each:
//
//   free  the second arm is held by nobody; the first is led by 30 mm at 0.1 m/s: what drag is felt
//         and how far the second is behind
//   vise  the second arm is held by 20 kN/m; the first is pushed with 2 N: how much of it is felt
//         at either end, how stiff the vise feels, whether all is still, who gives energy
//
// Errors: none today. Deterministic by seed.
struct TeleoperationSettings {
  std::uint64_t seed{1};
  Progress progress{};
};
[[nodiscard]] Result<Findings> run_teleoperation(const TeleoperationSettings& settings);

}  // namespace thimble::lab
