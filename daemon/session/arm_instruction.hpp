#pragma once

#include <string>

#include "daemon/session/arm_rig.hpp"
#include "daemon/world/world.hpp"

namespace thimble::session {

// What is in the way of the arm, or what its person is to do, in a sentence; empty: nothing. One
// that is gone asks for nothing else than to be there, one that stands after a fault for nothing
// else than to be cleared.
// Thread: control thread. Not RT.
[[nodiscard]] std::string instruction_for(ArmRig& rig);

// How far outside a world a finger that feels it is told of. Ours: no hand presses so deep into a
// wall, 8.5 N at 500 N/m are 17 mm, and one that leans on the outermost wall is not lost.
inline constexpr double kOutside_m = 0.02;

// The way into the world of a finger that is more than `least_m` outside of it, in whole
// millimetres: what is felt there is the outside of its walls. `finger`: world frame, as the world
// sees it: x to the right, y up, z nearer to the person. Empty: it is inside, or near, or the world
// has no end. Pure; total.
[[nodiscard]] std::string way_into(const world::WorldInfo& world, Position3 finger,
                                   double least_m = kOutside_m);

// The same for an arm in a world of this host: one that waits to be inside is told however near it
// is. Empty, too, of an arm whose position means nothing yet.
[[nodiscard]] std::string way_into(const world::WorldInfo& world, ArmRig& rig);

}  // namespace thimble::session
