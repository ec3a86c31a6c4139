#pragma once

#include <cstdint>

#include "daemon/world/ghost_slide.hpp"
#include "daemon/world/voxel_grid.hpp"
#include "daemon/world/world.hpp"
#include "hal/base/geometry.hpp"
#include "hal/base/time.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::world {

// Ours: fast enough that a filled cell of the thesis's 64^3 worlds (1.4 mm) is left in 14 ms,
// slow enough that an 800 N/m surface builds its force at 80 N/s, a tenth of what the limiter lets.
inline constexpr double kPushOutSpeed_m_s = 0.10;
// Ours: cells on every side that are searched for the nearest free one.
inline constexpr std::int32_t kPushOutReach = 4;

// What a ghost point remembers of how matter has it.
enum class GhostPhase : std::uint8_t {
  Loose,     // in a free cell; walls hold it, nothing else
  Caught,    // cells filled while it was at the hand: the hand may leave on any side
  Pressed,   // its cell filled while a wall held it: it must not get behind that wall
  Released,  // no way out in reach: it follows the hand, which feels nothing
};

struct GhostState {
  GhostPoint point{};
  GhostPhase phase{GhostPhase::Loose};
  bool is_held_back{false};  // after the last move the hand was elsewhere
  bool operator==(const GhostState&) const = default;
};

// One move of a ghost point towards the hand: slides along what is solid, and leaves a cell that
// has been filled around it (docs/ghost-motion.md). A pure function of its arguments; exchanging or
// mirroring axes of all of them does the same to the result, bit for bit.
//
// RT: THIMBLE_RT; bounded by the cells along the way and, in matter, by find_exit().
// Errors: none; a hand that is not finite leaves the state as it is and gives no planes.
THIMBLE_RT ProbeMotion move_ghost(const VoxelGrid& grid, GhostState& state, Position3 hand,
                                  Duration dt) noexcept;

}  // namespace thimble::world
