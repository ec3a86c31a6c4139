#pragma once

#include <memory>

#include "daemon/config/config.hpp"
#include "daemon/world/world.hpp"
#include "hal/base/result.hpp"

namespace thimble::session {

// The automaton that a configuration describes, as a world that is touched while it runs. Any
// thread; not RT.
// Errors: as LiveWorld::create().
[[nodiscard]] Result<std::unique_ptr<world::World>> make_live_world(
    const config::WorldConfig& said);

}  // namespace thimble::session
