#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

namespace thimble::lab {

// Told how many of the runs are done, by one thread at a time, though by any.
using Progress = std::function<void(std::size_t done, std::size_t all)>;

// `run(i)` for each i below `count`, on as many threads as the machine has processors: the outcome
// of one must not depend on another. In order of i. `run` must not throw.
template <class Run>
[[nodiscard]] auto run_all(std::size_t count, const Run& run, const Progress& progress) {
  using Outcome = std::invoke_result_t<const Run&, std::size_t>;
  std::vector<std::optional<Outcome>> outcomes(count);
  std::atomic<std::size_t> next{0};
  std::mutex telling;
  std::size_t done = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      outcomes[i] = run(i);
      const std::lock_guard lock(telling);
      ++done;
      if (progress) progress(done, count);
    }
  };
  const std::size_t threads = std::min<std::size_t>(count, std::thread::hardware_concurrency());
  std::vector<std::thread> others;
  for (std::size_t i = 1; i < threads; ++i) others.emplace_back(work);
  work();
  for (std::thread& other : others) other.join();
  std::vector<Outcome> all;
  all.reserve(outcomes.size());
  for (auto& outcome : outcomes) all.push_back(*std::move(outcome));
  return all;
}

}  // namespace thimble::lab
