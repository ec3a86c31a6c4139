#include "daemon/world/simple_constraints.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "grids.hpp"

namespace thimble::world {
namespace {

// Cells of 1 m, numbered from -4 to 3 by the coordinates of their lower faces; cells (., 0, .)
// occupied.
VoxelGrid slab() {
  VoxelGrid grid = empty_grid({8, 8, 8}, 1);
  for_each_cell(grid, [&](Cell c) { grid.set_occupied(c, c.y == 4); });
  return grid;
}

class SimpleConstraintsTest : public ::testing::Test {
 protected:
  ProbeMotion go(Position3 hand) { return constrain_simply(grid, sut, hand); }

  VoxelGrid grid = slab();
  SimpleConstraints sut = start_simple_constraints(grid, {0.5, -0.5, 0.5});
};

TEST_F(SimpleConstraintsTest, AHandInFreeCellsIsNotHeld) {
  EXPECT_TRUE(go({-3.5, -3.5, 2.5}).planes.empty());
  const ProbeMotion motion = go({2.5, -0.001, -3.5});
  EXPECT_TRUE(motion.planes.empty());
  EXPECT_FALSE(motion.is_embedded);
  EXPECT_EQ(motion.ghost, (Position3{2.5, -0.001, -3.5}));
}

TEST_F(SimpleConstraintsTest, TheFaceThatTheHandWentThroughHoldsIt) {
  const ProbeMotion motion = go({0.5, 0.3, 0.5});
  ASSERT_EQ(motion.planes.size(), 1U);
  EXPECT_EQ(motion.planes[0], (ContactPlane{{0, 1, 0}, 0}));
}

TEST_F(SimpleConstraintsTest, AHandThatOnlyTouchesAFaceIsNotThroughIt) {
  EXPECT_TRUE(go({0.5, 0, 0.5}).planes.empty());
  EXPECT_EQ(go({0.5, 1e-12, 0.5}).planes.size(), 1U);
  EXPECT_EQ(go({0.5, 0, 0.5}).planes.size(), 1U) << "it is not back in the free cell yet";
  EXPECT_TRUE(go({0.5, -1e-12, 0.5}).planes.empty());
  EXPECT_EQ(go({0.5, 1e-12, 0.5}).planes.size(), 1U);
}

TEST_F(SimpleConstraintsTest, HoldsBehindTheObstacleAndWhenComingBackThroughIt) {
  for (const double y : {0.5, 1.5, 2.5, 0.5}) {
    const ProbeMotion motion = go({0.5, y, 0.5});
    ASSERT_EQ(motion.planes.size(), 1U) << y;
    EXPECT_EQ(motion.planes[0], (ContactPlane{{0, 1, 0}, 0})) << y;
  }
  EXPECT_TRUE(go({0.5, -0.5, 0.5}).planes.empty());
}

TEST_F(SimpleConstraintsTest, FromTheOtherSideTheOtherFaceHolds) {
  sut = start_simple_constraints(grid, {0.5, 2.5, 0.5});
  const ProbeMotion motion = go({0.5, 0.5, 0.5});
  ASSERT_EQ(motion.planes.size(), 1U);
  EXPECT_EQ(motion.planes[0], (ContactPlane{{0, -1, 0}, -1}));
}

TEST_F(SimpleConstraintsTest, MovingWithinMatterSetsNothingNew) {
  go({0.5, 0.5, 0.5});
  EXPECT_EQ(go({3.5, 0.5, 3.5}).planes.size(), 1U);
}

TEST_F(SimpleConstraintsTest, TheWorldHasWalls) {
  const ProbeMotion motion = go({0.5, -0.5, -1e300});
  ASSERT_EQ(motion.planes.size(), 1U);
  EXPECT_EQ(motion.planes[0], (ContactPlane{{0, 0, -1}, 4}));
  EXPECT_TRUE(go({0.5, -0.5, 0.5}).planes.empty());
}

TEST_F(SimpleConstraintsTest, AHandThatAppearsInMatterIsHeldOnlyAfterItWasFree) {
  sut = start_simple_constraints(grid, {0.5, 0.5, 0.5});
  const ProbeMotion inside = go({1.5, 0.5, 0.5});
  EXPECT_TRUE(inside.planes.empty());
  EXPECT_TRUE(inside.is_embedded);
  EXPECT_TRUE(go({1.5, -0.5, 0.5}).planes.empty());
  EXPECT_EQ(go({1.5, 0.5, 0.5}).planes.size(), 1U);
}

TEST_F(SimpleConstraintsTest, AHandThatAppearsOutsideIsHeldByTheWallOfTheWorld) {
  sut = start_simple_constraints(grid, {9, -0.5, 0.5});
  const ProbeMotion motion = go({9, -0.5, 0.5});
  ASSERT_EQ(motion.planes.size(), 1U);
  EXPECT_EQ(motion.planes[0], (ContactPlane{{1, 0, 0}, 4}));
}

TEST_F(SimpleConstraintsTest, AHandThatIsNotFiniteChangesNothing) {
  go({0.5, 0.3, 0.5});
  const SimpleConstraints before = sut;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(go({0.5, nan, 0.5}).planes.empty());
  EXPECT_EQ(sut, before);
}

// Reference: the hand creeps in steps much smaller than a cell, and the thesis's sentences are
// applied to the cell numbers before and after each.
class Creeping {
 public:
  Creeping(const VoxelGrid& grid, Position3 hand) : grid_(grid), hand_(hand) {
    cell_ = cell_of(hand);
  }
  void go(Position3 hand) {
    constexpr int kSteps = 2000;
    for (int i = 1; i <= kSteps; ++i) {
      const Cell next = cell_of(hand_ + (hand - hand_) * (static_cast<double>(i) / kSteps));
      for (std::size_t axis = 0; axis < 3; ++axis) apply(axis, next);
      cell_ = next;
    }
    hand_ = hand;
  }
  [[nodiscard]] const std::array<std::int32_t, 3>& way() const { return way_; }
  [[nodiscard]] const std::array<std::int32_t, 3>& limit() const { return limit_; }

 private:
  [[nodiscard]] Cell cell_of(Position3 p) const {
    Cell cell;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      cell[axis] =
          static_cast<std::int32_t>(std::floor((p[axis] - grid_.face_m(axis, 0)) / grid_.cell_m()));
    }
    return cell;
  }
  void apply(std::size_t axis, Cell next) {
    if (way_[axis] > 0 && next[axis] < limit_[axis]) way_[axis] = 0;
    if (way_[axis] < 0 && next[axis] > limit_[axis]) way_[axis] = 0;
    if (way_[axis] != 0 || next[axis] == cell_[axis]) return;
    if (grid_.is_occupied(cell_) || !grid_.is_occupied(next)) return;
    way_[axis] = next[axis] - cell_[axis];
    limit_[axis] = next[axis];
  }

  const VoxelGrid& grid_;
  Position3 hand_;
  Cell cell_{};
  std::array<std::int32_t, 3> way_{};
  std::array<std::int32_t, 3> limit_{};  // "<" or ">" this cell
};

TEST(SimpleConstraints, AgreesWithCreepingInRandomWorlds) {
  std::mt19937 random(38);
  int held = 0;
  for (int world = 0; world < 100; ++world) {
    const VoxelGrid grid = random_grid(random, 0.3, 0.25);
    const Position3 start = center_of(grid, {0, 0, 0});
    SimpleConstraints sut = start_simple_constraints(grid, start);
    Creeping oracle(grid, start);
    Position3 hand = start;
    for (int move = 0; move < 20; ++move) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double bound_m = grid.face_m(axis, static_cast<std::int32_t>(grid.cells()[axis]) + 1);
        hand[axis] = std::clamp(hand[axis] + uniform(random, -0.4, 0.4), -bound_m, bound_m);
      }
      constrain_simply(grid, sut, hand);
      oracle.go(hand);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        ASSERT_EQ(sut.way[axis], oracle.way()[axis]) << world << ' ' << move;
        if (sut.way[axis] == 0) continue;
        ++held;
        const std::int32_t face = oracle.limit()[axis] + (sut.way[axis] > 0 ? 0 : 1);
        ASSERT_EQ(sut.face[axis], face);
      }
    }
  }
  EXPECT_GT(held, 500);
}

TEST(SimpleConstraints, MirroredWorldsAndHandsAreHeldByMirroredFaces) {
  std::mt19937 random(83);
  int held = 0;
  for (int world = 0; world < 100; ++world) {
    const VoxelGrid grid = random_grid(random, 0.3, 0.25);
    VoxelGrid mirror = grid;
    const auto last = static_cast<std::int32_t>(grid.cells()[1]) - 1;
    for_each_cell(grid, [&](Cell c) {
      mirror.set_occupied({c.x, last - c.y, c.z}, grid.is_occupied(c));
    });
    const Position3 start{0.01, 0.03, 0.02};
    SimpleConstraints sut = start_simple_constraints(grid, start);
    SimpleConstraints image = start_simple_constraints(mirror, {start.x, -start.y, start.z});
    for (int move = 0; move < 20; ++move) {
      const Position3 hand = random_point(random, grid);
      const ProbeMotion a = constrain_simply(grid, sut, hand);
      const ProbeMotion b = constrain_simply(mirror, image, {hand.x, -hand.y, hand.z});
      ASSERT_EQ(a.planes.size(), b.planes.size());
      for (std::size_t i = 0; i < a.planes.size(); ++i) {
        const Direction3 n = b.planes[i].normal;
        ASSERT_EQ(a.planes[i].normal, (Direction3{n.x, -n.y, n.z}));
        ASSERT_EQ(a.planes[i].offset_m, b.planes[i].offset_m);
        ++held;
      }
    }
  }
  EXPECT_GT(held, 500);
}

}  // namespace
}  // namespace thimble::world
