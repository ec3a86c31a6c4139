#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <vector>

#include "tests/vm/speed/processor_time.hpp"

// Plain, without headers of the project.

// What exchanges took, of one side.
struct RoundTripFigures {
  std::vector<double> trips_s;  // from a packet that is handed over until it came back
  double processor_s{0};        // of all threads of this process, for one exchange of as many more
};

// Of a plain program: `prepare(i)`, then `exchange()`, for i of 1 to `count` by the clock, which
// does not count what is prepared, and for as many more with no clock read between them. Nothing
// when one of them says false.
template <class Prepare, class Exchange>
std::optional<RoundTripFigures> measured(std::size_t count, Prepare prepare, Exchange exchange) {
  RoundTripFigures figures;
  for (std::size_t i = 1; i <= count; ++i) {
    if (!prepare(i)) return std::nullopt;
    const auto begin = std::chrono::steady_clock::now();
    if (!exchange()) return std::nullopt;
    const auto end = std::chrono::steady_clock::now();
    figures.trips_s.push_back(std::chrono::duration<double>(end - begin).count());
  }
  const double begin_s = process_processor_s();
  for (std::size_t i = count + 1; i <= 2 * count; ++i) {
    if (!prepare(i) || !exchange()) return std::nullopt;
  }
  figures.processor_s = (process_processor_s() - begin_s) / static_cast<double>(count);
  return figures;
}
