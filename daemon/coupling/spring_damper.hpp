#pragma once

#include <cstdint>

namespace thimble::coupling {

// Where a PD teleoperator computes its force (thesis 3.4, figure 3-2).
enum class ForceAt : std::uint8_t {
  World,  // "world": by the slave, and sent to the hand; the more usual
  Both,   // "both": at either end, which share position and velocity only
};

// What the damper between hand and slave has of B, the hand's own: a share, 0…1; less than all, or
// the delayed damper could drive (spring_damper_world.hpp). SOURCE: decision 0421.
inline constexpr double kDampingShare = 0.5;

}  // namespace thimble::coupling
