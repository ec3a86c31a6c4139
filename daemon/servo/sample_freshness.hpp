#pragma once

#include <cstdint>

#include "daemon/servo/miss_bucket.hpp"
#include "hal/base/time.hpp"
#include "hal/device/fault.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::servo {

// DESIGN section 4, row "no fresh sample from the arm".
struct FreshnessSettings {
  // Of exchanges: the longer one of the device's and the servo's.
  Duration exchange_period{std::chrono::milliseconds(1)};
  Duration hold{std::chrono::milliseconds(3)};
  Duration ramp_out{std::chrono::milliseconds(20)};
  Duration fault_after{std::chrono::milliseconds(20)};
  // Ours: twenty misses, so that one outage meets `fault_after` first and only repeated ones
  // fill the bucket. A single lost report counts nothing, a gap of n reports n - 1 misses.
  int bucket_limit{60};
};

struct FreshnessVerdict {
  double gain{1};                    // 1 while held, falling to 0 along ramp_out
  FaultCode fault{FaultCode::None};  // StaleSample or MissedExchanges
  bool is_stale{false};              // older than `hold`
  bool is_outage_over{false};        // this sample ends a stale time: restart the ghost
};

// Judges the age of the arm's newest sample. An exchange counts as missed when the sample's
// age passes another whole period of exchanges beyond the first, so two free-running clocks that
// beat against each other miss nothing. Misses fill a leaky bucket: +3 a miss, -1 a success.
//
// Thread: servo. RT: THIMBLE_RT.
class SampleFreshness {
 public:
  explicit SampleFreshness(const FreshnessSettings& settings) noexcept
      : settings_(settings), misses_(settings.exchange_period, settings.bucket_limit) {}

  // Forgets everything; the age counts from `now`.
  THIMBLE_RT void restart(MonotonicTime now) noexcept;
  // Once per tick. `sampled_at` belongs to the newest sample, `is_fresh`: it is new this tick.
  THIMBLE_RT FreshnessVerdict judge(MonotonicTime now, MonotonicTime sampled_at,
                                    bool is_fresh) noexcept;
  [[nodiscard]] std::uint64_t missed() const noexcept { return misses_.missed(); }

 private:
  FreshnessSettings settings_;
  MissBucket misses_;
  MonotonicTime newest_{};
  bool was_stale_{false};
};

}  // namespace thimble::servo
