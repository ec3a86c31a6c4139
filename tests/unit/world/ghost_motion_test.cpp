#include "daemon/world/ghost_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/unit/world/grids.hpp"

namespace thimble::world {
namespace {

constexpr Duration kTick = std::chrono::milliseconds(1);

// Every way two axes and their signs make the edge of a diagonal wall.
struct Diagonal {
  std::size_t u, v, w;
  int slope;
};
std::vector<Diagonal> all_diagonals() {
  std::vector<Diagonal> all;
  for (const auto& [u, v, w] : {std::array<std::size_t, 3>{0, 1, 2}, {1, 2, 0}, {2, 0, 1}}) {
    for (const int slope : {-1, 1}) all.push_back({u, v, w, slope});
  }
  return all;
}

// Cells along a diagonal of the u-v plane, touching one another only at edges.
VoxelGrid diagonal_wall(const Diagonal& d, std::int32_t count) {
  const auto n = static_cast<std::uint32_t>(count);
  VoxelGrid grid = empty_grid({n, n, n}, 1.0 / 32);
  for_each_cell(grid, [&](Cell c) {
    const std::int32_t v = d.slope > 0 ? c[d.v] : count - 1 - c[d.v];
    grid.set_occupied(c, c[d.u] + v == count - 1);
  });
  return grid;
}

TEST(GhostMotion, NeverPassesADiagonalWallOneCellThick) {
  std::mt19937 random(20);
  constexpr std::int32_t kCount = 32;
  const auto diagonals = all_diagonals();
  for (int push = 0; push < 200; ++push) {
    const Diagonal& d = diagonals[static_cast<std::size_t>(push) % diagonals.size()];
    const VoxelGrid grid = diagonal_wall(d, kCount);
    const auto side = [&](Cell c) {
      return c[d.u] + (d.slope > 0 ? c[d.v] : kCount - 1 - c[d.v]) - (kCount - 1);
    };
    const int way = push % 2 == 0 ? 1 : -1;
    // Half of the pushes run exactly through the edges shared by two cells of the wall.
    const bool is_dead_on = push % 4 < 2;
    Position3 start;
    Position3 end;
    start[d.w] = is_dead_on ? 0.01 : uniform(random, -0.4, 0.4);
    end[d.w] = is_dead_on ? 0.01 : uniform(random, -0.4, 0.4);
    start[d.u] = -way * (is_dead_on ? 0.25 : uniform(random, 0.2, 0.3));
    start[d.v] = -way * d.slope * (is_dead_on ? 0.25 : uniform(random, 0.2, 0.3));
    end[d.u] = way * (is_dead_on ? 0.25 : uniform(random, 0.2, 0.3));
    end[d.v] = way * d.slope * (is_dead_on ? 0.25 : uniform(random, 0.2, 0.3));
    Cell cell;
    for (std::size_t axis = 0; axis < 3; ++axis) cell[axis] = grid.lower_index(axis, start[axis]);
    GhostState sut{{start, cell}, GhostPhase::Loose, false};
    ASSERT_LT(side(cell) * way, 0);
    for (int tick = 0; tick <= 300; ++tick) {
      const Position3 hand = start + (end - start) * (tick / 300.0);
      const ProbeMotion motion = move_ghost(grid, sut, hand, kTick);
      ASSERT_LT(side(sut.point.cell) * way, 0) << push << " tick " << tick;
      ASSERT_FALSE(motion.is_embedded);
    }
    EXPECT_NE(sut.point.position, end);
  }
}

TEST(GhostMotion, StaysInACornerOfThreeWalls) {
  std::mt19937 random(21);
  const VoxelGrid grid = make_box(30).value();
  const double wall_m = grid.face_m(0, 20);
  for (int push = 0; push < 200; ++push) {
    const bool is_dead_on = push % 2 == 0;
    Position3 end;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int way = ((push >> (axis + 1)) & 1) != 0 ? 1 : -1;
      end[axis] = way * (is_dead_on ? 2 * wall_m : uniform(random, 1.05, 3) * wall_m);
    }
    GhostState sut = ghost_in(grid, {15, 15, 15});
    ProbeMotion motion;
    for (int tick = 0; tick <= 200; ++tick) {
      motion = move_ghost(grid, sut, Position3{} + (end - Position3{}) * (tick / 200.0), kTick);
    }
    ASSERT_EQ(motion.planes.size(), 3U);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(motion.ghost[axis], std::copysign(wall_m, end[axis]));
      EXPECT_EQ(motion.planes[axis].normal[axis], std::copysign(1, end[axis]));
      EXPECT_EQ(motion.planes[axis].offset_m, wall_m);
    }
  }
}

TEST(GhostMotion, FindsAllThreeWallsOfACornerInOneMove) {
  const VoxelGrid grid = make_box(3).value();
  GhostState sut = ghost_in(grid, {1, 1, 1});
  EXPECT_EQ(move_ghost(grid, sut, {0.02, -0.03, 0.05}, kTick).planes.size(), 3U);
}

TEST(GhostMotion, SlidesOverAFlatFaceWithoutSidewaysForceAndWithConstantNormal) {
  std::mt19937 random(22);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const int way : {-1, 1}) {
      VoxelGrid grid = empty_grid({32, 32, 32}, 1.0 / 32);
      for_each_cell(grid,
                    [&](Cell c) { grid.set_occupied(c, way > 0 ? c[axis] >= 16 : c[axis] < 16); });
      Cell home{10, 10, 10};
      home[axis] = way > 0 ? 14 : 17;
      GhostState sut = ghost_in(grid, home);
      Position3 hand = sut.point.position;
      Displacement3 step;
      for (int tick = 0; tick < 2000; ++tick) {
        if (tick % 50 == 0) {
          for (std::size_t a = 0; a < 3; ++a) step[a] = uniform(random, -0.01, 0.01);
        }
        for (std::size_t a = 0; a < 3; ++a) {
          hand[a] = std::clamp(hand[a] + step[a], -0.4, 0.4);
        }
        hand[axis] = way * grid.cell_m();  // one cell deep
        const Force3 force = pull_on(hand, move_ghost(grid, sut, hand, kTick));
        Force3 expected;
        expected[axis] = -way * grid.cell_m();
        ASSERT_EQ(force, expected);
      }
    }
  }
}

// Figures 3-8 and 3-9 of the thesis: cells (column, row) of 1 m, row up; z is one cell thick.
class ThesisFigure : public ::testing::Test {
 protected:
  ThesisFigure() { grid.set_occupied({1, 2, 0}, true); }
  ProbeMotion move_to(double column, double row) {
    return move_ghost(grid, sut, {column - 2, row - 2, 0}, kTick);
  }
  VoxelGrid grid = empty_grid({4, 4, 1}, 1.0);
  GhostState sut = ghost_in(grid, {1, 1, 0});
};

TEST_F(ThesisFigure, AFreeCellConstrainsNothing) { EXPECT_TRUE(move_to(1.7, 1.9).planes.empty()); }

TEST_F(ThesisFigure, AnOccupiedCellSetsOnePlaneAtItsFace) {
  const ProbeMotion motion = move_to(1.5, 2.4);
  ASSERT_EQ(motion.planes.size(), 1U);
  EXPECT_EQ(motion.planes[0].normal, (Direction3{0, 1, 0}));
  EXPECT_EQ(motion.planes[0].offset_m, 0);
}

TEST_F(ThesisFigure, ReturningLiftsThePlane) {
  move_to(1.5, 2.4);
  EXPECT_TRUE(move_to(1.5, 1.8).planes.empty());
}

TEST_F(ThesisFigure, PassingRightThroughKeepsThePlane) {
  move_to(1.5, 2.4);
  EXPECT_EQ(move_to(1.5, 3.5).planes.size(), 1U);
}

TEST_F(ThesisFigure, GoingRoundTheObstacleLiftsThePlane) {
  move_to(1.5, 2.4);
  move_to(1.5, 3.5);
  EXPECT_TRUE(move_to(0.5, 3.5).planes.empty());
  EXPECT_EQ(sut.point.cell, (Cell{0, 3, 0}));
}

TEST(GhostMotion, ReportsATouchedFaceAlikeOnBothSides) {
  const VoxelGrid grid = make_box(3).value();
  for (const int way : {-1, 1}) {
    GhostState sut = ghost_in(grid, {1, 1, 1});
    const double face = grid.face_m(1, way > 0 ? 2 : 1);
    const ProbeMotion motion = move_ghost(grid, sut, {0, face, 0}, kTick);
    ASSERT_EQ(motion.planes.size(), 1U);
    EXPECT_EQ(motion.planes[0].normal, (Direction3{0, static_cast<double>(way), 0}));
    EXPECT_EQ(motion.planes[0].offset_m, way * face);
    EXPECT_EQ(motion.ghost, (Position3{0, face, 0}));
  }
}

TEST(GhostMotion, AHandThatIsNotFiniteMovesNothing) {
  const VoxelGrid grid = make_box(3).value();
  GhostState sut = ghost_in(grid, {1, 1, 1});
  move_ghost(grid, sut, {0.001, 0.02, 0}, kTick);
  const GhostState before = sut;
  const double inf = std::numeric_limits<double>::infinity();
  for (const Position3 hand :
       {Position3{std::nan(""), 0, 0}, Position3{0, inf, 0}, Position3{0, 0, -inf}}) {
    const ProbeMotion motion = move_ghost(grid, sut, hand, kTick);
    EXPECT_TRUE(motion.planes.empty());
    EXPECT_EQ(motion.ghost, before.point.position);
    EXPECT_EQ(sut, before);
  }
}

TEST(GhostMotion, AHugeHandIsHeldByTheOuterWalls) {
  const VoxelGrid grid = empty_grid({4, 4, 4}, 0.5);
  for (const double far : {1.5, 1e10, 1e300, std::numeric_limits<double>::max()}) {
    GhostState sut = ghost_in(grid, {1, 1, 1});
    const ProbeMotion motion = move_ghost(grid, sut, {far, -far, 0.25}, kTick);
    EXPECT_EQ(motion.ghost, (Position3{1, -1, 0.25}));
    ASSERT_EQ(motion.planes.size(), 2U);
    EXPECT_EQ(motion.planes[1].normal, (Direction3{0, -1, 0}));
    EXPECT_EQ(motion.planes[1].offset_m, 1);
  }
}

}  // namespace
}  // namespace thimble::world
