#include "hal/linux/monotonic_clock.hpp"

#include <cerrno>
#include <ctime>

namespace thimble::linux {

MonotonicTime MonotonicClock::now() const noexcept {
  timespec t{};
  ::clock_gettime(CLOCK_BOOTTIME, &t);  // cannot fail for this clock
  return {std::chrono::seconds(t.tv_sec) + std::chrono::nanoseconds(t.tv_nsec)};
}

Duration MonotonicClock::sleep_until(MonotonicTime deadline) noexcept {
  MonotonicTime woke = now();
  if (woke >= deadline) return woke - deadline;  // so a negative time never reaches the kernel

  const auto whole = std::chrono::duration_cast<std::chrono::seconds>(deadline.since_epoch);
  timespec t{};
  t.tv_sec = whole.count();
  t.tv_nsec = (deadline.since_epoch - whole).count();
  while (::clock_nanosleep(CLOCK_BOOTTIME, TIMER_ABSTIME, &t, nullptr) == EINTR) {
  }
  woke = now();
  return woke > deadline ? woke - deadline : Duration(0);
}

}  // namespace thimble::linux
