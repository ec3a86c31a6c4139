#pragma once

#include <string>
#include <vector>

#include "tests/campaign/episode.hpp"

namespace thimble::campaign {

// For a person: what was played, what went wrong on purpose, and what came of it.
[[nodiscard]] std::string to_text(const Tally& tally);

// The kinds of faults, of the bus, the link and the events, of which there was not one, in the
// report's words. Of the events, edits are left out: not every client makes every kind.
[[nodiscard]] std::vector<std::string> never_struck(const Tally& tally);

}  // namespace thimble::campaign
