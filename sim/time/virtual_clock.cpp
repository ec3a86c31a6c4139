#include "sim/time/virtual_clock.hpp"

#include "hal/base/check.hpp"

namespace thimble::sim {

Duration VirtualClock::sleep_until(MonotonicTime deadline) noexcept {
  THIMBLE_CHECK(!is_running_);
  is_running_ = true;
  const MonotonicTime start = now();
  const MonotonicTime limit = deadline < start ? start : deadline;
  MonotonicTime due{};
  while (Event* event = events_.take_due(limit, due)) {
    if (due > now()) set_now(due);  // time never runs backwards for one scheduled in the past
    event->fire(now());
  }
  set_now(limit);
  is_running_ = false;
  return limit - deadline;
}

}  // namespace thimble::sim
