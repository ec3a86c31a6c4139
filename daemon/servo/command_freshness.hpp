#pragma once

#include <cstdint>
#include <optional>

#include "daemon/servo/miss_bucket.hpp"
#include "daemon/servo/sample_freshness.hpp"
#include "hal/base/time.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::servo {

// Judges how long the arm has taken no command: a write that is blocked, or a bus that fails all of
// them, counts as missed exchanges though samples come. An exchange that fails both ways is that of
// the samples, and counts once: a controller in lock-step with its host falls silent, too. Age is
// that of the oldest command in a row that found the way out shut; a servo that is faster than its
// bus, and an arm that takes one every second tick, miss nothing, nor does a servo that was away.
//
// Thread: servo. RT: THIMBLE_RT.
class CommandFreshness {
 public:
  // Of `settings` it uses the period of exchanges and the bucket's limit.
  explicit CommandFreshness(const FreshnessSettings& settings) noexcept
      : exchange_period_(settings.exchange_period),
        misses_(settings.exchange_period, settings.bucket_limit) {}

  // Forgets all but the count.
  THIMBLE_RT void restart() noexcept {
    shut_since_.reset();
    misses_.restart();
  }
  // Once per write. `is_taken`: it was IoStatus::Ok. `sample_age`: of the newest sample.
  THIMBLE_RT void judge(MonotonicTime now, bool is_taken, Duration sample_age) noexcept {
    if (is_taken) {
      shut_since_.reset();
      return misses_.succeed();
    }
    shut_since_ = shut_since_.value_or(now);
    const Duration age = now - *shut_since_;
    if (sample_age >= 2 * exchange_period_) return misses_.pass(age);  // SampleFreshness counts it
    misses_.wait(age);
  }
  // FaultCode::MissedExchanges is due: only of repeated blocks, for a single one meets
  // ServoSettings::command_gap_limit first.
  [[nodiscard]] bool is_full() const noexcept { return misses_.is_full(); }
  [[nodiscard]] std::uint64_t missed() const noexcept { return misses_.missed(); }

 private:
  Duration exchange_period_;
  MissBucket misses_;
  std::optional<MonotonicTime> shut_since_;
};

}  // namespace thimble::servo
