#pragma once

#include <string>

#include "daemon/session/arm_rig.hpp"

namespace thimble::session {

// What is in the way of the arm, or what its person is to do, in a sentence; empty: nothing. One
// that is gone asks for nothing else than to be there, one that stands after a fault for nothing
// else than to be cleared.
// Thread: control thread. Not RT.
[[nodiscard]] std::string instruction_for(ArmRig& rig);

}  // namespace thimble::session
