#pragma once

#include <chrono>
#include <compare>
#include <cstdint>

namespace thimble {

// Nanoseconds, signed 64 bit: 292 years, exact.
using Duration = std::chrono::nanoseconds;

// A point on the time line of one Clock. Points of different clocks do not mix; nothing
// checks that, so each component is given exactly one Clock that stamps its data.
struct MonotonicTime {
  Duration since_epoch{};

  auto operator<=>(const MonotonicTime&) const = default;
  friend constexpr MonotonicTime operator+(MonotonicTime t, Duration d) noexcept {
    return {t.since_epoch + d};
  }
  friend constexpr MonotonicTime operator-(MonotonicTime t, Duration d) noexcept {
    return {t.since_epoch - d};
  }
  friend constexpr Duration operator-(MonotonicTime a, MonotonicTime b) noexcept {
    return a.since_epoch - b.since_epoch;
  }
};

[[nodiscard]] constexpr double seconds(Duration d) noexcept {
  return std::chrono::duration<double>(d).count();
}
// Rounds to the nearest nanosecond. `s` must be finite and within ±200 years.
[[nodiscard]] constexpr Duration from_seconds(double s) noexcept {
  return Duration(static_cast<std::int64_t>(s * 1e9 + (s < 0 ? -0.5 : 0.5)));
}

// The only way to learn the time. Implementations: linux::MonotonicClock (the machine's),
// sim::VirtualClock (sleeping runs the event queue), sim::RealTimeBrake (virtual time that
// follows the machine's and waits for a late servo).
//
// Thread: now() from any thread; sleep_until() only from the thread that owns the loop.
// RT: now() is THIMBLE_RT; sleep_until() is THIMBLE_RT_IO (its one system call is the sleep).
class Clock {
 public:
  virtual ~Clock() = default;
  [[nodiscard]] virtual MonotonicTime now() const noexcept = 0;
  // Returns how late the caller woke (>= 0). At once when `deadline` has passed.
  virtual Duration sleep_until(MonotonicTime deadline) noexcept = 0;
};

}  // namespace thimble
