#pragma once

namespace thimble {

// Ends the process after saying what was broken. Not RT; never returns.
[[noreturn]] void check_failed(const char* expression, const char* file, int line) noexcept;

}  // namespace thimble

// A broken invariant of our own code (never a reaction to input). Always compiled in.
// In the servo plane use it only before the loop starts.
#define THIMBLE_CHECK(expression) \
  ((expression) ? static_cast<void>(0) : ::thimble::check_failed(#expression, __FILE__, __LINE__))
