#pragma once

#include "tests/campaign/episode.hpp"

namespace thimble::campaign {

// A rule that every longer press of the e-stop breaks, in place of those that hold: with it a
// campaign fails for certain, which shows what it does then.
[[nodiscard]] Planted planted_breach();

}  // namespace thimble::campaign
