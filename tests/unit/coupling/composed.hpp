#pragma once

#include <utility>

#include "daemon/coupling/composite_arm.hpp"
#include "daemon/coupling/composite_world.hpp"
#include "daemon/coupling/tell.hpp"
#include "daemon/world/ghost_motion.hpp"
#include "daemon/world/voxel_world.hpp"
#include "linked_loop.hpp"

namespace thimble::coupling::testing {

inline GhostPointSettings in_cells_of(double cell_m) { return {.cell_m = cell_m}; }

// Our own scheme on a link, in a world of cells.
struct Composed {
  Composed(const world::VoxelGrid& grid, Duration dt, const link::ImpairmentSettings& impairment)
      : cells(grid, "cells"),
        arm(in_cells_of(grid.cell_m())),
        world(cells, 1),
        loop(arm, world, dt, impairment) {}

  ArmOutput rest(Position3 tip, double seconds_) {
    ArmOutput out;
    for (double t = 0; t < seconds_; t += seconds(loop.dt())) out = loop.tick(tip, {});
    return out;
  }

  world::VoxelWorld cells;
  CompositeArm arm;
  CompositeWorld world;
  LinkedLoop loop;
};

// The ghost point with a world that answers in no time.
class UndelayedGhostPoint {
 public:
  UndelayedGhostPoint(world::VoxelGrid grid, Position3 at, world::Cell cell)
      : grid_(std::move(grid)), ghost_{{at, cell}}, arm_(in_cells_of(grid_.cell_m())) {
    arm_.reset({}, at);
    set_.session = 1;
  }
  ArmOutput tick(Position3 tip, Velocity3 velocity, Duration dt) {
    now_ = now_ + dt;
    ++set_.sequence;
    set_.planes = planes_of(move_ghost(grid_, ghost_, tip + arm_.offset(), dt));
    return arm_.step({.now = now_, .dt = dt, .tip = tip, .tip_velocity = velocity, .fresh = &set_});
  }
  [[nodiscard]] Position3 ghost() const { return ghost_.point.position; }

 private:
  world::VoxelGrid grid_;
  world::GhostState ghost_;
  GhostPointArm arm_;
  ConstraintSet set_{};
  MonotonicTime now_{};
};

}  // namespace thimble::coupling::testing
