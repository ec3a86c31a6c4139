#pragma once

#include <ctime>

// Plain, without headers of the project: both sides are measured by it.

// Seconds of a processor that all threads of this process have had so far, in it and in the kernel
// on its behalf; 0 where the system does not say. Exact to the clock's own grain: the kernel adds a
// thread's share up when it switches from it, and the caller's now (posix-cpu-timers.c), where
// /proc/self/task/*/schedstat lacks the caller's since the last timer interrupt.
[[nodiscard]] inline double process_processor_s() noexcept {
  timespec spent{};
  if (clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &spent) != 0) return 0;
  return static_cast<double>(spent.tv_sec) + 1e-9 * static_cast<double>(spent.tv_nsec);
}
