#pragma once

#include "hal/base/geometry.hpp"

namespace thimble::world {

// A cube in a cubic room, both across the axes of the world frame and the room centered on its
// origin. The cube starts in the middle.
struct BlockScene {
  double room_m{0.09};  // the thesis's workspace
  double edge_m{0.03};  // below room_m
  // Ours. It swims in oil: a push of 1 N moves it at 1/drag, and nothing goes on by itself.
  double drag_newton_s_per_m{40};
  double friction{0};  // Coulomb's coefficient between its faces and hands
  Force3 weight{};     // N, world frame: pulls it all the time
};

}  // namespace thimble::world
