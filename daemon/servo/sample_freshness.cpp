#include "daemon/servo/sample_freshness.hpp"

#include <algorithm>

namespace thimble::servo {

void SampleFreshness::restart(MonotonicTime now) noexcept {
  newest_ = now;
  misses_.restart();
  was_stale_ = false;
}

FreshnessVerdict SampleFreshness::judge(MonotonicTime now, MonotonicTime sampled_at,
                                        bool is_fresh) noexcept {
  FreshnessVerdict verdict;
  if (is_fresh) {
    newest_ = std::max(newest_, sampled_at);
    misses_.succeed();
    verdict.is_outage_over = was_stale_;
  }
  const Duration age = now - newest_;
  misses_.wait(age);

  verdict.is_stale = age > settings_.hold;
  was_stale_ = verdict.is_stale;
  if (verdict.is_stale) {
    const double gone = seconds(age - settings_.hold) / seconds(settings_.ramp_out);
    verdict.gain = std::clamp(1.0 - gone, 0.0, 1.0);
  }
  if (age >= settings_.fault_after) {
    verdict.fault = FaultCode::StaleSample;
  } else if (misses_.is_full()) {
    verdict.fault = FaultCode::MissedExchanges;
  }
  if (verdict.fault != FaultCode::None) verdict.gain = 0;
  return verdict;
}

}  // namespace thimble::servo
