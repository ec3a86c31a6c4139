#include "hal/linux/realtime_report.hpp"

namespace thimble::linux {

Result<void> enforce(RealtimePolicy policy, const RealtimeReport& report) {
  if (policy == RealtimePolicy::BestEffort || !report.is_degraded()) return {};
  std::string message = "real time is required, but: ";
  for (const std::string& entry : report.missing) {
    if (&entry != &report.missing.front()) message += "; ";
    message += entry;
  }
  return fail(Errc::Permission, std::move(message));
}

}  // namespace thimble::linux
