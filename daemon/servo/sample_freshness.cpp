#include "daemon/servo/sample_freshness.hpp"

#include <algorithm>

namespace thimble::servo {

void SampleFreshness::restart(MonotonicTime now) noexcept {
  newest_ = now;
  periods_counted_ = 0;
  bucket_ = 0;
  was_stale_ = false;
}

FreshnessVerdict SampleFreshness::judge(MonotonicTime now, MonotonicTime sampled_at,
                                        bool is_fresh) noexcept {
  FreshnessVerdict verdict;
  if (is_fresh) {
    newest_ = std::max(newest_, sampled_at);
    periods_counted_ = 0;
    bucket_ = std::max(0, bucket_ - 1);
    verdict.is_outage_over = was_stale_;
  }
  const Duration age = now - newest_;

  // The sample of the running period may still be on its way: the first period is no miss.
  const std::int64_t periods = age / settings_.device_period - 1;
  if (periods > periods_counted_) {
    const std::int64_t misses = periods - periods_counted_;
    periods_counted_ = periods;
    missed_ += static_cast<std::uint64_t>(misses);
    const std::int64_t filled = bucket_ + 3 * misses;
    bucket_ = static_cast<int>(std::min<std::int64_t>(filled, settings_.bucket_limit));
  }

  verdict.is_stale = age > settings_.hold;
  was_stale_ = verdict.is_stale;
  if (verdict.is_stale) {
    const double gone = seconds(age - settings_.hold) / seconds(settings_.ramp_out);
    verdict.gain = std::clamp(1.0 - gone, 0.0, 1.0);
  }
  if (age >= settings_.fault_after) {
    verdict.fault = FaultCode::StaleSample;
  } else if (bucket_ >= settings_.bucket_limit) {
    verdict.fault = FaultCode::MissedExchanges;
  }
  if (verdict.fault != FaultCode::None) verdict.gain = 0;
  return verdict;
}

}  // namespace thimble::servo
