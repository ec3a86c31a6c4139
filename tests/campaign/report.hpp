#pragma once

#include <string>

#include "tests/campaign/episode.hpp"

namespace thimble::campaign {

// For a person: what was played, what went wrong on purpose, and what came of it.
[[nodiscard]] std::string to_text(const Tally& tally);

}  // namespace thimble::campaign
