#pragma once

#include <algorithm>
#include <cstdint>

#include "hal/base/time.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::servo {

// Counts the periods of exchanges in which something did not come that should come once in each,
// from its age, and fills a leaky bucket with them: +3 a miss, -1 a success. The first period is no
// miss: what belongs to the running one may still be on its way.
//
// Thread: servo. RT: THIMBLE_RT.
class MissBucket {
 public:
  // `limit`: where it is full.
  MissBucket(Duration exchange_period, int limit) noexcept
      : exchange_period_(exchange_period), limit_(limit) {}

  // Empty; what was counted stays.
  THIMBLE_RT void restart() noexcept {
    periods_counted_ = 0;
    bucket_ = 0;
  }
  THIMBLE_RT void succeed() noexcept {
    periods_counted_ = 0;
    bucket_ = std::max(0, bucket_ - 1);
  }
  // What has not come is `age` old, which only grows until it succeeds.
  THIMBLE_RT void wait(Duration age) noexcept {
    const std::int64_t periods = age / exchange_period_ - 1;
    if (periods <= periods_counted_) return;
    const std::int64_t misses = periods - periods_counted_;
    periods_counted_ = periods;
    missed_ += static_cast<std::uint64_t>(misses);
    bucket_ = static_cast<int>(std::min<std::int64_t>(bucket_ + 3 * misses, limit_));
  }
  // The same of periods that are counted elsewhere.
  THIMBLE_RT void pass(Duration age) noexcept {
    periods_counted_ = std::max<std::int64_t>(periods_counted_, age / exchange_period_ - 1);
  }
  [[nodiscard]] bool is_full() const noexcept { return bucket_ >= limit_; }
  [[nodiscard]] std::uint64_t missed() const noexcept { return missed_; }

 private:
  Duration exchange_period_;
  int limit_;
  std::int64_t periods_counted_{0};
  std::uint64_t missed_{0};
  int bucket_{0};
};

}  // namespace thimble::servo
