#pragma once

#include <chrono>
#include <thread>

namespace thimble::test {

// For tests of the real threads of a bus, which no virtual clock moves: looks until `is_done`, and
// sleeps in between so that those threads run. False when it is not for as long as a stalled
// machine may need, 20 s at least.
template <class Condition>
[[nodiscard]] bool wait_until(const Condition& is_done) {
  constexpr int kLooks = 200'000;
  for (int i = 0; i < kLooks; ++i) {
    if (is_done()) return true;
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  return false;
}

}  // namespace thimble::test
