#pragma once

#include <ctime>

namespace thimble::bench {

// Seconds of a processor that the calling thread has had so far; 0 where the system does not say.
// What others have of a busy machine meanwhile is not in it, so that a figure is the program's own.
[[nodiscard]] inline double processor_s() noexcept {
  timespec spent{};
  if (clock_gettime(CLOCK_THREAD_CPUTIME_ID, &spent) != 0) return 0;
  return static_cast<double>(spent.tv_sec) + 1e-9 * static_cast<double>(spent.tv_nsec);
}

}  // namespace thimble::bench
