#pragma once

#include <chrono>
#include <cstdint>

#include "daemon/coupling/messages.hpp"

namespace thimble::coupling::testing {

inline constexpr Duration kTick = std::chrono::milliseconds(1);

// What an arm tells in its `sequence`th tick.
inline HandSample sample(std::uint64_t sequence, Position3 hand) {
  return {.sequence = sequence, .sampled_at = {kTick * static_cast<int>(sequence)}, .hand = hand};
}

}  // namespace thimble::coupling::testing
