#include "daemon/servo/servo_runner.hpp"

#include <cstdint>
#include <optional>

namespace thimble::servo {
namespace {

// Zero is sent for so long after the ramp: several frames of a full-speed bus (1 ms each), so
// that losing one report does not leave a force.
constexpr Duration kFinalZero = std::chrono::milliseconds(5);

// Whole periods to leave out because they are over; those that the lateness of the wake-up does
// not explain passed within the tick, which has not counted them.
std::int64_t skip_missed(ServoLoop& loop, Duration behind, Duration lateness) noexcept {
  const Duration period = loop.settings().period();
  if (behind < period) return 0;
  const std::int64_t missed = behind / period;
  const std::int64_t unexplained = missed - lateness / period;
  if (unexplained > 0) loop.count_skipped(static_cast<std::uint64_t>(unexplained));
  return missed;
}

}  // namespace

void run_servo(ServoLoop& loop, Clock& clock, const std::atomic<bool>& is_stopping) noexcept {
  const Duration period = loop.settings().period();
  MonotonicTime next = clock.now() + period;
  std::optional<MonotonicTime> end_at;
  while (!end_at || clock.now() < *end_at) {
    const Duration lateness = clock.sleep_until(next);
    loop.tick(lateness);
    const MonotonicTime now = clock.now();
    next = next + period;
    next = next + skip_missed(loop, now - next, lateness) * period;
    if (!is_stopping.load(std::memory_order_relaxed)) continue;
    loop.release();
    if (!end_at && loop.is_at_rest()) end_at = now + kFinalZero;
  }
}

}  // namespace thimble::servo
