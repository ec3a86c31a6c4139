#pragma once

#include <cstdint>
#include <span>

#include "hal/base/time.hpp"
#include "hal/rt/annotations.hpp"
#include "sim/fault/fault_plan.hpp"

namespace thimble::sim {

// Cuts output reports short where they enter a device: TruncateOut of a plan, and nothing else of
// it. Above the plug it cannot be done, since a bus sends reports of the device's size only.
//
// Thread: one, that of the device. RT: all but set_plan(). Errors: none.
// What happens to report n depends on the plan and n only.
class ShortReports {
 public:
  // For every report from now on; the number of the next one stays what it is.
  void set_plan(FaultPlan plan);
  // What is left of the report that enters at `now`: all of it, or less, down to nothing. Valid for
  // as long as `report` is.
  THIMBLE_RT [[nodiscard]] std::span<const std::uint8_t> pass(std::span<const std::uint8_t> report,
                                                              MonotonicTime now) noexcept;
  [[nodiscard]] std::uint64_t cut() const noexcept { return cut_; }

 private:
  [[nodiscard]] bool strikes(MonotonicTime now) const noexcept;

  FaultPlan plan_;
  std::uint64_t reports_{0};
  std::uint64_t cut_{0};
};

}  // namespace thimble::sim
