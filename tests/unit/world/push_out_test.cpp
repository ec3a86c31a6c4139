#include "daemon/world/push_out.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "daemon/world/ghost_motion.hpp"
#include "tests/unit/world/grids.hpp"

namespace thimble::world {
namespace {

constexpr Duration kTick = std::chrono::milliseconds(1);
constexpr double kStep_m = kPushOutSpeed_m_s * 1e-3;

void fill_block(VoxelGrid& grid, Cell center, std::int32_t radius) {
  for_each_cell(grid, [&](Cell c) {
    bool is_in = true;
    for (std::size_t a = 0; a < 3; ++a) is_in = is_in && std::abs(c[a] - center[a]) <= radius;
    if (is_in) grid.set_occupied(c, true);
  });
}

TEST(FindExit, FindsTheNearestFreeCellOfTheNeighbourhood) {
  std::mt19937 random(30);
  for (int world = 0; world < 300; ++world) {
    const VoxelGrid grid = random_grid(random, 0.9, 0.25);
    Position3 anchor;
    for (std::size_t a = 0; a < 3; ++a) anchor[a] = uniform(random, -0.2, 0.2);
    const auto sut = find_exit(grid, {anchor, {}, false, {}, kPushOutReach});
    double nearest_m = 1e9;
    for_each_cell(grid, [&](Cell c) {
      if (grid.is_occupied(c)) return;
      double d2 = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        const double outside = std::max(std::abs(anchor[a] - center_of(grid, c)[a]) - 0.125, 0.0);
        d2 += outside * outside;
      }
      nearest_m = std::min(nearest_m, std::sqrt(d2));
    });
    if (nearest_m > 1) continue;  // beyond the reach in a world of this size
    ASSERT_TRUE(sut);
    EXPECT_NEAR(sut->distance_m, nearest_m, 1e-12);
    EXPECT_FALSE(grid.is_occupied(sut->at.cell));
    EXPECT_NEAR(norm(sut->at.position - anchor), nearest_m, 1e-12);
  }
}

TEST(FindExit, BreaksATieTowardsTheHandAndElsePassesItOver) {
  VoxelGrid grid = empty_grid({5, 5, 5}, 1.0);
  grid.fill();
  grid.set_occupied({1, 2, 2}, false);
  grid.set_occupied({3, 2, 2}, false);
  const Cell home{2, 2, 2};
  EXPECT_EQ(find_exit(grid, {{}, {0.1, 0, 0}, false, home, 4})->at.cell, (Cell{3, 2, 2}));
  EXPECT_EQ(find_exit(grid, {{}, {-0.1, 0, 0}, false, home, 4})->at.cell, (Cell{1, 2, 2}));
  EXPECT_FALSE(find_exit(grid, {{}, {0, 0.1, 0}, false, home, 4}));
  grid.set_occupied({2, 2, 0}, false);
  EXPECT_EQ(find_exit(grid, {{}, {0, 0.1, 0}, false, home, 4})->at.cell, (Cell{2, 2, 0}));
}

TEST(SymmetricSum, DoesNotDependOnTheOrder) {
  std::mt19937 random(31);
  for (int i = 0; i < 1000; ++i) {
    const double a = uniform(random, -1, 1), b = uniform(random, -1, 1) * 1e-8;
    const double c = uniform(random, -1, 1) * 1e8;
    const double sut = symmetric_sum(a, b, c);
    for (const double other :
         {symmetric_sum(a, c, b), symmetric_sum(b, a, c), symmetric_sum(b, c, a),
          symmetric_sum(c, a, b), symmetric_sum(c, b, a)}) {
      ASSERT_EQ(sut, other);
    }
    ASSERT_NEAR(sut, a + b + c, 1e-7);
  }
}

TEST(PushOut, MovesAtBoundedSpeedTheShortestWayAndPressesSmoothly) {
  VoxelGrid grid = empty_grid({9, 9, 9}, 0.01);
  GhostState sut = ghost_in(grid, {4, 4, 4});
  const Position3 hand{0.003, 0, 0};  // nearest exit: +x, 2 mm away
  move_ghost(grid, sut, hand, kTick);
  fill_block(grid, {4, 4, 4}, 0);
  double last_pull = 0;
  int ticks = 0;
  for (; ticks < 100; ++ticks) {
    const Position3 before = sut.point.position;
    const ProbeMotion motion = move_ghost(grid, sut, hand, kTick);
    ASSERT_LE(norm(motion.ghost - before), kStep_m * (1 + 1e-9));
    const Force3 pull = pull_on(hand, motion);
    ASSERT_EQ(pull.y, 0);
    ASSERT_EQ(pull.z, 0);
    ASSERT_GE(pull.x, last_pull);
    ASSERT_LE(pull.x - last_pull, kStep_m * (1 + 1e-9));
    last_pull = pull.x;
    if (!motion.is_embedded) break;
  }
  EXPECT_NEAR(ticks, 20, 1);
  EXPECT_EQ(sut.point.cell, (Cell{5, 4, 4}));
  EXPECT_NEAR(last_pull, 0.002, 1e-12);
  // Out, it stays out, and holds the hand as any wall does.
  const ProbeMotion after = move_ghost(grid, sut, hand, kTick);
  EXPECT_FALSE(after.is_embedded);
  EXPECT_NEAR(pull_on(hand, after).x, 0.002, 1e-12);
}

TEST(PushOut, AGrowingWallPushesThePressingHandBackNotThroughIt) {
  // A wall one cell thick, free behind: the hand presses through it when the cell before it fills.
  VoxelGrid grid = empty_grid({9, 9, 9}, 0.01);
  for_each_cell(grid, [&](Cell c) { grid.set_occupied(c, c.x == 5); });
  GhostState sut = ghost_in(grid, {4, 4, 4});
  const Position3 hand{0.018, 0.001, 0.0005};
  ASSERT_EQ(move_ghost(grid, sut, hand, kTick).planes.size(), 1U);
  for_each_cell(grid, [&](Cell c) { grid.set_occupied(c, c.x == 5 || c.x == 4); });
  for (int tick = 0; tick < 200; ++tick) {
    const ProbeMotion motion = move_ghost(grid, sut, hand, kTick);
    ASSERT_LE(motion.ghost.x, 0.005);
    ASSERT_LT(pull_on(hand, motion).x, 0);
  }
  EXPECT_EQ(sut.point.cell.x, 3);
  EXPECT_EQ(sut.point.position.x, grid.face_m(0, 4));
}

TEST(PushOut, WithoutAWayOutReleasesAndGivesTheGhostBackInAFreeCell) {
  VoxelGrid grid = empty_grid({21, 21, 21}, 0.01);
  GhostState sut = ghost_in(grid, {10, 10, 10});
  fill_block(grid, {10, 10, 10}, 6);
  Position3 hand{0.001, 0.002, 0};
  ProbeMotion motion = move_ghost(grid, sut, hand, kTick);
  EXPECT_EQ(sut.phase, GhostPhase::Released);
  for (; hand.x < 0.09; hand.x += 0.0002) {
    motion = move_ghost(grid, sut, hand, kTick);
    ASSERT_TRUE(motion.planes.empty());
    ASSERT_EQ(motion.ghost, hand);
    ASSERT_EQ(motion.is_embedded, hand.x < 0.065) << hand.x;
  }
  EXPECT_EQ(sut.phase, GhostPhase::Loose);
  // And the block is solid again from outside.
  motion = move_ghost(grid, sut, {0.05, 0.002, 0}, kTick);
  EXPECT_EQ(motion.planes.size(), 1U);
}

// The test that the best-known library fails: cells fill around the hand, the hand withdraws.
TEST(PushOut, AHandThatWithdrawsFromFilledCellsIsLetGo) {
  std::mt19937 random(32);
  for (int run = 0; run < 400; ++run) {
    VoxelGrid grid = empty_grid({33, 33, 33}, 1.0 / 256);
    GhostState sut = ghost_in(grid, {16, 16, 16});
    Position3 hand;
    for (std::size_t a = 0; a < 3; ++a) {
      hand[a] = run % 4 == 0 ? 0 : uniform(random, -0.5, 0.5) * grid.cell_m();
    }
    move_ghost(grid, sut, hand, kTick);
    const int radius = run % 6;
    fill_block(grid, {16, 16, 16}, radius);
    Displacement3 way;
    do {
      for (std::size_t a = 0; a < 3; ++a) way[a] = index_below(random, 3) - 1;
    } while (norm(way) == 0);
    const double step_m = uniform(random, 0.02, 1.0) * 1e-3;
    const double depth_m = (2 * radius + 1) * grid.cell_m();
    const double target_m = depth_m + 3.5 * grid.cell_m();
    for (double gone_m = 0; gone_m < target_m; gone_m += step_m) {
      hand = hand + way * (step_m / norm(way));
      const ProbeMotion motion = move_ghost(grid, sut, hand, kTick);
      const Force3 pull = pull_on(hand, motion);
      ASSERT_TRUE(is_finite(motion.ghost));
      ASSERT_LE(norm(pull), depth_m) << run;
      bool is_out = false;
      for (std::size_t a = 0; a < 3; ++a) {
        is_out = is_out || std::abs(hand[a]) > (radius + 0.5) * grid.cell_m();
      }
      if (!is_out) continue;
      ASSERT_EQ(norm(pull), 0) << run;
      ASSERT_EQ(motion.ghost, hand) << run;
      ASSERT_FALSE(motion.is_embedded) << run;
    }
  }
}

TEST(PushOut, NeverTrapsWhileCellsFlipAtEveryStep) {
  std::mt19937 random(33);
  for (int run = 0; run < 40; ++run) {
    VoxelGrid grid = empty_grid({17, 17, 17}, 0.002);
    GhostState sut = ghost_in(grid, {8, 8, 8});
    Position3 hand;
    const double share = uniform(random, 0.1, 1.0);
    for (int tick = 0; tick < 1500; ++tick) {
      for (int flip = 0; flip < 40; ++flip) {
        Cell c;
        for (std::size_t a = 0; a < 3; ++a) {
          c[a] = grid.lower_index(a, hand[a]) + index_below(random, 7) - 3;
        }
        grid.set_occupied(c, uniform(random, 0, 1) < share);
      }
      for (std::size_t a = 0; a < 3; ++a) {
        hand[a] = std::clamp(hand[a] + uniform(random, -3e-4, 3e-4), -0.02, 0.02);
      }
      const ProbeMotion motion = move_ghost(grid, sut, hand, kTick);
      ASSERT_TRUE(is_finite(motion.ghost));
      ASSERT_LE(motion.planes.size(), 3U);
      for (const ContactPlane& plane : motion.planes) ASSERT_TRUE(std::isfinite(plane.offset_m));
      const bool is_free = !grid.is_occupied(sut.point.cell);
      ASSERT_TRUE(is_free || motion.is_embedded);
    }
    // The dust settles: a hand in free space has its ghost back.
    for_each_cell(grid, [&](Cell c) { grid.set_occupied(c, false); });
    hand = {0.001, 0.002, 0.003};
    const ProbeMotion motion = move_ghost(grid, sut, hand, kTick);
    EXPECT_EQ(motion.ghost, hand);
    EXPECT_TRUE(motion.planes.empty());
    EXPECT_FALSE(motion.is_embedded);
  }
}

TEST(PushOut, ATickOfNoLengthMovesNothing) {
  VoxelGrid grid = empty_grid({9, 9, 9}, 0.01);
  GhostState sut = ghost_in(grid, {4, 4, 4});
  fill_block(grid, {4, 4, 4}, 1);
  const Position3 hand{0.003, 0, 0};
  for (const Duration dt : {Duration{0}, Duration{-5}}) {
    const ProbeMotion motion = move_ghost(grid, sut, hand, dt);
    EXPECT_EQ(motion.ghost, (Position3{}));
    EXPECT_TRUE(motion.is_embedded);
  }
}

}  // namespace
}  // namespace thimble::world
