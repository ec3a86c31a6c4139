#pragma once

#include <string>

#include "daemon/servo/entry_box.hpp"
#include "daemon/session/arm_rig.hpp"

namespace thimble::session {

// Whether what an arm that stands after a fault knows of its place is lost once it is cleared: its
// controller was silent for longer than its watchdog, in which it may have been reset (decision
// 0103). Pure.
[[nodiscard]] bool will_be_forgotten(const HapticCapabilities& can,
                                     const servo::ServoFrame& frame) noexcept;

// What is in the way of the arm, or what its person is to do, in a sentence; empty: nothing. One
// that is gone asks for nothing else than to be there, one that stands after a fault for nothing
// else than to be cleared, and calibrated where that will be lost.
// Thread: control thread. Not RT.
[[nodiscard]] std::string instruction_for(ArmRig& rig);

// The way into the free part of a world of a finger that may not begin where it is, in whole
// millimetres. Base frame of the arm: x to the right, y up, z nearer to the person. Empty: it is
// inside, or leans on an outermost wall, or the world has no end. Pure; total.
[[nodiscard]] std::string way_into(const servo::EntryBox& entry, Position3 finger);

// The same for an arm in a world of this host, inactive or active. What an active one feels out
// there is the outside of walls.
[[nodiscard]] std::string way_in(ArmRig& rig);

}  // namespace thimble::session
