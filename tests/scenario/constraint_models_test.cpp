#include <gtest/gtest.h>

#include <string>

#include "daemon/coupling/ghost_point_world.hpp"
#include "daemon/coupling/simple_constraint_world.hpp"
#include "daemon/world/voxel_world.hpp"
#include "tests/support/arm_watch.hpp"
#include "tests/support/guided_hand.hpp"

// The cases of thesis figures 3-8 and 3-9 in closed loop, each in both constraint models. A world
// of 4 x 4 cells of 20 mm seen along z, named (x, y) as in the text; all free but an obstacle.
// Where the text gives no cells: 3-8e and f leave the obstacle sideways, from within it and from
// behind it; 3-9a and b are the way to the 3-9c that it describes.
namespace thimble {
namespace {

using test::ClosedLoop;

constexpr double kCell_m = 0.02;

Position3 middle(int x, int y) { return {(x - 1.5) * kCell_m, (y - 1.5) * kCell_m, 0.01}; }
double lower_face_m(int y) { return (y - 2) * kCell_m; }

class Figure : public ::testing::TestWithParam<const char*> {
 protected:
  explicit Figure(int obstacle_y) {
    auto& world = dynamic_cast<world::VoxelWorld&>(loop.world());
    for (world::Cell cell; cell.x < 4; ++cell.x) {
      for (cell.y = 0; cell.y < 4; ++cell.y) {
        for (cell.z = 0; cell.z < 4; ++cell.z) {
          world.set_cell(cell, cell.x == 1 && cell.y == obstacle_y);
        }
      }
    }
    loop.run_until_driven();
  }
  // To the middle of a cell; nothing may be broken on the way.
  void go(test::GuidedHand& hand, int x, int y) {
    hand.go(middle(x, y), [this] { watch.see(); });
    EXPECT_EQ(watch.breach(), "");
    EXPECT_EQ(loop.snapshot().faults, 0U);
  }
  [[nodiscard]] static bool is_simple() { return std::string(GetParam()) == "simple"; }
  // Nothing is felt.
  void expect_free() {
    EXPECT_FALSE(loop.frame().is_in_contact);
    EXPECT_EQ(norm(loop.frame().wish), 0);
  }
  // One wall is felt: below `y` it would be gone.
  void expect_held_below(int y) {
    const servo::ServoFrame& frame = loop.frame();
    EXPECT_TRUE(frame.is_in_contact);
    const double depth_m = frame.tip.y + frame.offset.y - lower_face_m(y);
    EXPECT_GT(depth_m, 0.002);
    EXPECT_LT(frame.wish.y, -800 * depth_m * 0.9);
    EXPECT_EQ(frame.wish.x, 0);
    EXPECT_EQ(frame.wish.z, 0);
  }

  ClosedLoop loop{{"world.source=box:4", "world.workspace_m=0.08",
                   std::string("world.constraint_model=") + GetParam(), "arm.hand.motion=still"}};
  test::ArmWatch watch{loop};
};

class Figure38 : public Figure {
 protected:
  Figure38() : Figure(/*obstacle_y=*/2) { go(hand, 1, 1); }
  test::GuidedHand hand{loop};
};

TEST_P(Figure38, ANothingHoldsAHandInAFreeCell) {
  expect_free();
  go(hand, 0, 1);
  go(hand, 0, 0);
  expect_free();
}

TEST_P(Figure38, BTheFaceOfTheOccupiedCellHoldsIt) {
  go(hand, 1, 2);
  expect_held_below(2);
}

TEST_P(Figure38, CBackInTheFreeCellNothingHoldsIt) {
  go(hand, 1, 2);
  go(hand, 1, 1);
  expect_free();
}

TEST_P(Figure38, DPushedRightThroughItIsStillHeld) {
  go(hand, 1, 3);
  expect_held_below(2);
}

TEST_P(Figure38, ESidewaysOutOfTheObstacleOnlyTheSimpleModelHoldsOn) {
  go(hand, 1, 2);
  go(hand, 0, 2);
  is_simple() ? expect_held_below(2) : expect_free();
}

TEST_P(Figure38, FSidewaysFromBehindTheObstacleOnlyTheSimpleModelHoldsOn) {
  go(hand, 1, 3);
  go(hand, 0, 3);
  is_simple() ? expect_held_below(2) : expect_free();
  go(hand, 0, 1);
  expect_free();
}

INSTANTIATE_TEST_SUITE_P(InBothModels, Figure38, ::testing::Values("ghost-point", "simple"),
                         [](const auto& model) {
                           return std::string(model.param) == "simple" ? "Simple" : "GhostPoint";
                         });

class Figure39 : public Figure {
 protected:
  Figure39() : Figure(/*obstacle_y=*/1) { go(hand, 1, 0); }
  test::GuidedHand hand{loop};
};

TEST_P(Figure39, ANothingHoldsAHandInAFreeCell) { expect_free(); }

TEST_P(Figure39, BPushedFarBehindTheObstacleItIsHeldByTheFirstFace) {
  go(hand, 1, 3);
  expect_held_below(1);
}

TEST_P(Figure39, CPastTheObstaclesEdgeTheGhostIsDraggedRoundAndTheConstraintLifted) {
  go(hand, 1, 3);
  go(hand, 0, 3);
  is_simple() ? expect_held_below(1) : expect_free();
}

INSTANTIATE_TEST_SUITE_P(InBothModels, Figure39, ::testing::Values("ghost-point", "simple"),
                         [](const auto& model) {
                           return std::string(model.param) == "simple" ? "Simple" : "GhostPoint";
                         });

// The same figure where the ghost itself can be seen: at the world's side.
TEST(Figure39Ghost, TracksTheHandInFreeSpaceStaysAtTheFaceAndIsDraggedRound) {
  world::VoxelGrid grid = world::VoxelGrid::create({4, 4, 4}, kCell_m).value();
  for (int z = 0; z < 4; ++z) grid.set_occupied({1, 1, z}, true);
  world::VoxelWorld world(grid, "figure 3-9");
  coupling::GhostPointWorld sut(world, 1);
  coupling::HandSample sample{.sequence = 1, .hand = middle(1, 0)};
  ASSERT_TRUE(sut.open(sample));
  const auto answer_at = [&](Position3 hand) {
    sample.hand = hand;
    return sut.answer(sample, std::chrono::milliseconds(1));
  };
  EXPECT_EQ(answer_at(middle(1, 0)).ghost, middle(1, 0));  // a
  const coupling::ConstraintSet b = answer_at(middle(1, 3));
  EXPECT_EQ(b.ghost, (Position3{middle(1, 0).x, lower_face_m(1), 0.01}));
  ASSERT_EQ(b.planes.size(), 1U);
  EXPECT_EQ(b.planes[0].normal, (Direction3{0, 1, 0}));
  EXPECT_EQ(b.planes[0].offset_m, lower_face_m(1));
  const coupling::ConstraintSet edge = answer_at({lower_face_m(1), middle(1, 3).y, 0.01});
  EXPECT_EQ(edge.ghost, (Position3{lower_face_m(1), lower_face_m(1), 0.01}))
      << "on the edge: not past it";
  const coupling::ConstraintSet c = answer_at(middle(0, 3));
  EXPECT_EQ(c.ghost, middle(0, 3));
  EXPECT_TRUE(c.planes.empty());
}

}  // namespace
}  // namespace thimble
