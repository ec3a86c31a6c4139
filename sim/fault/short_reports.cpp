#include "sim/fault/short_reports.hpp"

#include <algorithm>
#include <utility>

namespace thimble::sim {

void ShortReports::set_plan(FaultPlan plan) {
  plan_ = std::move(plan);
  std::erase_if(plan_.script,
                [](const ScriptedFault& fault) { return fault.kind != FaultKind::TruncateOut; });
}

std::span<const std::uint8_t> ShortReports::pass(std::span<const std::uint8_t> report,
                                                 MonotonicTime now) noexcept {
  ++reports_;
  if (report.empty() || !strikes(now)) return report;
  ++cut_;
  return report.first(fault_bits(plan_.seed + 1, FaultKind::TruncateOut, reports_) % report.size());
}

bool ShortReports::strikes(MonotonicTime now) const noexcept {
  return std::any_of(plan_.script.begin(), plan_.script.end(),
                     [&](const ScriptedFault& fault) {
                       return fault.covers(now) && fault.covers(reports_);
                     }) ||
         fault_strikes(fault_bits(plan_.seed, FaultKind::TruncateOut, reports_),
                       plan_.random.truncate_out);
}

}  // namespace thimble::sim
