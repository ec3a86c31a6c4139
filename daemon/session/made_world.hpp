#pragma once

#include <memory>

#include "daemon/world/world.hpp"
#include "sim/model/cam/sim_usb_cam_board.hpp"

namespace thimble::session {

// What make_world() gives. Plain; belongs to whoever has it, and goes with him.
struct MadeWorld {
  std::unique_ptr<world::World> world;
  // What it lives on, to be pulled out and plugged in; nullptr where it is on no simulated USB.
  std::shared_ptr<sim::cam::SimUsbCamBoard> usb_board;
};

}  // namespace thimble::session
