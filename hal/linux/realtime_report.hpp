#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/base/result.hpp"

namespace thimble::linux {

enum class RealtimePolicy : std::uint8_t {
  Required,    // without every right below the daemon does not run
  BestEffort,  // runs with what it gets; the status shows "degraded"
};

// Which real-time rights were granted; `missing` names each one that was not, and its cure.
// Thread: a value; whoever has it. Not RT: it has strings. Ownership: none shared.
struct RealtimeReport {
  bool has_fifo{false};
  bool has_affinity{false};  // true also when no CPU was asked for
  bool has_memory_lock{false};
  bool has_dma_latency{false};
  std::vector<std::string> missing;

  [[nodiscard]] bool is_degraded() const noexcept { return !missing.empty(); }
};

// Thread: any. Not RT. Errors: Permission that lists all of it, where the policy is Required and
// something is missing.
[[nodiscard]] Result<void> enforce(RealtimePolicy policy, const RealtimeReport& report);

}  // namespace thimble::linux
