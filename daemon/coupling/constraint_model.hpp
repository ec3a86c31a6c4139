#pragma once

#include <cstdint>
#include <memory>

#include "daemon/coupling/world_coupling.hpp"
#include "daemon/world/world.hpp"
#include "hal/base/result.hpp"

namespace thimble::coupling {

// How a world decides what holds a hand; the answer on the wire is the same kind.
enum class ConstraintModel : std::uint8_t {
  GhostPoint,  // "ghost-point": thesis 3.7.1, figure 3-9
  Simple,      // "simple": thesis 3.7.1, figure 3-8, with its faults
};

// The world half of `model` in `world`, which must outlive it. Sessions are numbered as by
// GhostPointWorld. Thread: control plane's, before the half is used; allocates. Errors:
// Unsupported, "simple" in a world without cells.
[[nodiscard]] Result<std::unique_ptr<WorldCoupling>> make_world_coupling(
    ConstraintModel model, world::World& world, std::uint32_t first_session);

}  // namespace thimble::coupling
