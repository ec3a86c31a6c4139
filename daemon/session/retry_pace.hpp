#pragma once

#include <algorithm>
#include <optional>

#include "hal/base/time.hpp"

namespace thimble::session {

// When to try again what may fail for long: at once, then after kFirst, then twice as long each
// time, at least every kLongest. Thread: one. Pure.
class RetryPace {
 public:
  [[nodiscard]] bool is_due(MonotonicTime now) const noexcept { return !next_ || now >= *next_; }
  void tried(MonotonicTime now) noexcept {
    next_ = now + rest_;
    rest_ = std::min(2 * rest_, kLongest);
  }
  // It went well: the next failure is the first again, though not tried sooner than was said.
  void ease() noexcept { rest_ = kFirst; }
  // There is a reason to try at once.
  void restart() noexcept { *this = RetryPace(); }
  // Of the next try; nothing: at once.
  [[nodiscard]] std::optional<MonotonicTime> next() const noexcept { return next_; }

  // Ours: a freshly plugged device is ready within a second, and a look at the bus costs
  // milliseconds.
  static constexpr Duration kFirst = std::chrono::milliseconds(50);
  static constexpr Duration kLongest = std::chrono::seconds(2);

 private:
  Duration rest_{kFirst};
  std::optional<MonotonicTime> next_;
};

}  // namespace thimble::session
