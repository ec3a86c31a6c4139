#pragma once

#include <chrono>
#include <ctime>

#include "hal/base/time.hpp"

namespace thimble::linux {

// A span, which must not be below 0, as the kernel's waits take it; exact. Thread: any. RT: not
// used there (MonotonicClock has its own).
// Errors: none.
[[nodiscard]] inline timespec to_timespec(Duration span) noexcept {
  const auto whole = std::chrono::duration_cast<std::chrono::seconds>(span);
  return {whole.count(), (span - whole).count()};
}

}  // namespace thimble::linux
