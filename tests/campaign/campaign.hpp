#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "tests/campaign/episode.hpp"

namespace thimble::campaign {

struct Order {
  std::uint64_t ticks{1'000'000'000};  // in all; the last episode is cut to it
  std::uint64_t seed{1};
  unsigned jobs{1};
};

struct Failure {
  std::uint64_t episode{0};
  Programme programme;
  Ending ending;
};

struct Outcome {
  Tally tally;
  // Of all episodes, whoever played them: the same order gives the same.
  std::uint64_t trace{0};
  std::optional<Failure> failure;  // the first by number; no later episode is begun
};

// Programme number `episode` of an order of any length.
[[nodiscard]] Programme programme_of(const Order& order, std::uint64_t episode);

// Plays episode after episode until `order.ticks` are done or one breaks a rule.
// Thread: `progress` is called by one at a time, after every episode.
[[nodiscard]] Outcome run(const Order& order, const Planted& planted = {},
                          const std::function<void(const Tally&)>& progress = {});

}  // namespace thimble::campaign
