#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "tests/campaign/invariant.hpp"
#include "tests/campaign/programme.hpp"

namespace thimble::campaign {

// Plays a programme and says how it broke, if it did.
using Play = std::function<std::optional<Breach>(const Programme&)>;

struct Shrunk {
  Programme programme;
  Breach breach;
  std::uint64_t plays{0};
};

// The smallest programme it finds that breaks the same rule as `failing` does: fewer events first
// (delta debugging: Zeller, Hildebrandt 2002), then a plainer configuration, then fewer ticks.
// Deterministic. Plays at most `most_plays` times; what it has by then is the answer.
// `failing` must break a rule: nothing when it does not.
[[nodiscard]] std::optional<Shrunk> shrink(const Programme& failing, const Play& play,
                                           std::uint64_t most_plays = 400);

}  // namespace thimble::campaign
