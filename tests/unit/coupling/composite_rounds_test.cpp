#include <gtest/gtest.h>

#include <algorithm>

#include "daemon/coupling/composite_world.hpp"
#include "daemon/world/occupancy_mirror.hpp"
#include "daemon/world/voxel_world.hpp"
#include "hand_samples.hpp"

namespace thimble::coupling {
namespace {

using testing::kTick;

// A world that runs, and a peer who hears every answer.
struct Rounds {
  Rounds() { EXPECT_TRUE(half.open(testing::sample(1, {}))); }

  void tick() {
    HandSample sample = testing::sample(++samples, {});
    sample.applied_reply = samples - 1;
    const ConstraintSet told = half.answer(sample, kTick);
    if (told.map.epoch != epoch) {
      ++rounds;
      ASSERT_TRUE(mirror.begin(told.map.lattice));
    }
    epoch = told.map.epoch;
    for (const world::OccupancyBlock& block : told.map.blocks) {
      newest = std::max(newest, block.version);
      (void)mirror.learn(block);
    }
  }
  [[nodiscard]] int cells_that_differ() const {
    int differ = 0;
    for (world::Cell c{}; c.z < 9; ++c.z) {
      for (c.y = 0; c.y < 9; ++c.y) {
        for (c.x = 0; c.x < 9; ++c.x) {
          const bool is_same = mirror.is_occupied(c) == cells.grid()->is_occupied(c);
          if (!mirror.is_known(c) || !is_same) ++differ;
        }
      }
    }
    return differ;
  }

  static constexpr std::uint32_t kVersions = 40;
  world::VoxelWorld cells{world::VoxelGrid::create({9, 9, 9}, 0.01).value(), "cells"};
  CompositeWorld half{cells, 1, kVersions};
  world::OccupancyMirror mirror;
  std::uint64_t samples{0};
  std::uint64_t epoch{0};
  std::uint32_t newest{0};
  int rounds{0};
};

// As after weeks of a world that runs, for which 40 versions are enough here.
TEST(CompositeRounds, WhereVersionsAreUsedUpAllIsToldAnew) {
  Rounds sut;
  for (int turn = 0; turn < 300; ++turn) {
    sut.cells.set_cell({turn % 9, turn / 9 % 9, 4}, turn % 2 == 0);
    for (int i = 0; i < 30; ++i) sut.tick();
    ASSERT_EQ(sut.cells_that_differ(), 0) << turn;
    ASSERT_EQ(sut.half.cells_epoch(), sut.epoch);
  }
  EXPECT_GT(sut.rounds, 5);
  EXPECT_LT(sut.newest, 2 * Rounds::kVersions);
}

}  // namespace
}  // namespace thimble::coupling
