#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "daemon/world/voxel_world.hpp"
#include "grids.hpp"

// Defects of the printed servers (docs/thesis-defects.md), absent in our worlds.
namespace thimble::world {
namespace {

constexpr Duration kTick = std::chrono::milliseconds(1);

// 64 cells of 1.4 mm, as on the CAM-8.
VoxelGrid of_the_cam() { return empty_grid({64, 64, 64}, kDefaultWorkspace_m / 64); }

TEST(ThesisDefect, TheWorldHasWallsWhereItsEdgeCellsAreFree) {
  VoxelWorld sut(of_the_cam(), "free");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const double side : {1.0, -1.0}) {
      const ProbeId probe = sut.add_probe({}).value();
      Position3 hand;
      hand[axis] = side * 0.060;
      const ProbeMotion motion = sut.move_probe(probe, hand, kTick);
      ASSERT_EQ(motion.planes.size(), 1U);
      EXPECT_EQ(motion.planes[0].normal[axis], side);
      EXPECT_DOUBLE_EQ(motion.planes[0].offset_m, kDefaultWorkspace_m / 2);
      sut.remove_probe(probe);
    }
  }
}

TEST(ThesisDefect, NoPartIsTooThinToStopTheGhost) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    VoxelGrid grid = of_the_cam();
    for_each_cell(grid, [&](Cell c) { grid.set_occupied(c, c[axis] == 40); });
    VoxelWorld sut(grid, "sheet");
    const ProbeId probe = sut.add_probe({}).value();
    Position3 hand;
    hand[axis] = 0.040;  // 28 cells in one sample, with the sheet half-way
    const ProbeMotion motion = sut.move_probe(probe, hand, kTick);
    EXPECT_DOUBLE_EQ(motion.ghost[axis], grid.face_m(axis, 40));
    ASSERT_EQ(motion.planes.size(), 1U);
  }
}

// The printed one takes x, then y, then z, and z in small steps only.
TEST(ThesisDefect, EveryAxisGoesAsFarInOneSampleAndNoneGoesFirst) {
  std::mt19937 random(27);
  int differing = 0;
  for (int world = 0; world < 200; ++world) {
    const VoxelGrid grid = random_grid(random, 0.25, 0.25);
    const auto& n = grid.cells();
    VoxelGrid turned = empty_grid({n[1], n[2], n[0]}, 0.25);
    for_each_cell(grid, [&](Cell c) { turned.set_occupied({c.y, c.z, c.x}, grid.is_occupied(c)); });
    VoxelWorld one(grid, "one");
    VoxelWorld other(turned, "turned");
    const auto a = one.add_probe({0.01, 0.02, 0.03});
    const auto b = other.add_probe({0.02, 0.03, 0.01});
    if (!a || !b ||
        grid.is_occupied({static_cast<std::int32_t>(n[0]) / 2, static_cast<std::int32_t>(n[1]) / 2,
                          static_cast<std::int32_t>(n[2]) / 2})) {
      continue;  // starts by what lies around it, which is not the question
    }
    for (int move = 0; move < 20; ++move) {
      const Position3 hand = random_point(random, grid);
      const Position3 g = one.move_probe(*a, hand, kTick).ghost;
      const Position3 h = other.move_probe(*b, {hand.y, hand.z, hand.x}, kTick).ghost;
      ASSERT_EQ(h, (Position3{g.y, g.z, g.x}));
      ++differing;
    }
  }
  EXPECT_GT(differing, 500);
}

TEST(ThesisDefect, TheGhostStartsInTheCellOfTheHandForAnyCount) {
  for (const std::uint32_t cells : {1U, 2U, 3U, 33U, 64U}) {
    VoxelWorld sut(empty_grid({cells, cells, cells}, 0.01), "free");
    for (const Position3 hand : {Position3{}, Position3{0.004, -0.001, 0.002}}) {
      const ProbeId probe = sut.add_probe(hand).value();
      const ProbeMotion motion = sut.move_probe(probe, hand, kTick);
      EXPECT_EQ(motion.ghost, hand) << cells;
      EXPECT_TRUE(motion.planes.empty());
      sut.remove_probe(probe);
    }
  }
}

}  // namespace
}  // namespace thimble::world
