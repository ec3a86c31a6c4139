#pragma once

#include "daemon/config/config.hpp"
#include "daemon/world/world.hpp"
#include "hal/base/result.hpp"

namespace thimble::session {

// Which worlds go with which schemes: the table of docs/worlds-and-schemes.md. Pure. Errors:
// Unsupported, with the reason and what to use instead.

// What is said of the world itself: its constraint model, and whether it listens.
[[nodiscard]] Result<void> check_combination(const world::World& world,
                                             const config::WorldConfig& said);
// An arm that touches `world` in this process.
[[nodiscard]] Result<void> check_combination(const world::World& world,
                                             const config::CouplingConfig& arm);

}  // namespace thimble::session
