#pragma once

#include <cstdint>

#include "hal/base/result.hpp"
#include "lab/findings/findings.hpp"
#include "lab/trial/parallel.hpp"

// The thesis's table 4.1: how far the frame is displaced by a wall that is learned of late.
namespace thimble::lab {

struct Table41Settings {
  std::uint64_t contacts{
      1000};  // of each row, at least 1; of those in lock-step four times as many
  std::uint64_t seed{1};
  Progress progress{};
};

// Both readings of the thesis's client (it waited for each reply; or it streamed), a hand that
// nothing stops and a finger that gives way; then jitter, loss and reordering. The criteria are
// those of teleop.md section 4. Deterministic by seed; takes a minute for each 1,000 contacts.
// Errors: the first run's that failed.
[[nodiscard]] Result<Findings> run_table_4_1(const Table41Settings& settings);

}  // namespace thimble::lab
