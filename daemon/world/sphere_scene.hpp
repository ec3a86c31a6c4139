#pragma once

#include "hal/base/geometry.hpp"

namespace thimble::world {

// The matter of thesis 3.2: a ball, and everything below a floor. World frame, y up. They may stand
// apart, touch, or the floor may cut the ball; its top is above the floor.
struct SphereScene {
  Position3 center{};
  double radius_m{0};
  double floor_m{0};  // y of the floor
};

}  // namespace thimble::world
