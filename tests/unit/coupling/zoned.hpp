#pragma once

#include "daemon/coupling/buffer_zone_arm.hpp"
#include "daemon/coupling/buffer_zone_world.hpp"
#include "daemon/world/voxel_world.hpp"
#include "linked_loop.hpp"

namespace thimble::coupling::testing {

// A buffer zone on a link, in a world of cells.
struct Zoned {
  Zoned(const world::VoxelGrid& grid, const BufferZoneWorldSettings& settings, Duration dt,
        const link::ImpairmentSettings& impairment)
      : cells(grid, "cells"), world(cells, 1, settings), loop(arm, world, dt, impairment) {}

  // Long enough for the first answer, and for the force to have risen.
  void rest(Position3 tip, double seconds_) {
    for (double t = 0; t < seconds_; t += seconds(loop.dt())) (void)loop.tick(tip, {});
  }

  world::VoxelWorld cells;
  BufferZoneArm arm;
  BufferZoneWorld world;
  LinkedLoop loop;
};

}  // namespace thimble::coupling::testing
