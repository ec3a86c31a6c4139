#include "daemon/world/block_push.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace thimble::world {
namespace {

constexpr double kStiffness = 800;
constexpr double kDrag = 40;

BlockOil oil(double friction) { return {kStiffness, kDrag, friction, 0.03}; }

// `hand_m` rests while the block goes on in `steps`.
BlockMotion after(double friction, const BlockHold& hold, Force3 weight, double time_s, int steps) {
  BlockMotion motion{{}, hold};
  for (int i = 0; i < steps; ++i) {
    motion = push_block(oil(friction), motion.hold, motion.center, weight, time_s / steps);
  }
  return motion;
}

void expect_near(Position3 a, Position3 b, double within_m) {
  for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(a[axis], b[axis], within_m) << axis;
}

TEST(BlockPush, WhatSticksGoesAlongAsTheSpringAndTheDragSay) {
  const BlockHold hold{.axis = 0, .sign = 1, .depth_m = 0.003, .stretch = {0, 0.001, -0.0005}};
  const double share = 1 - std::exp(-kStiffness * 0.02 / kDrag);
  const BlockMotion motion = after(0.5, hold, {}, 0.02, 1);
  expect_near(motion.center, {0.003 * share, 0.001 * share, -0.0005 * share}, 1e-15);
  EXPECT_NEAR(motion.hold.depth_m, 0.003 * (1 - share), 1e-15);
  EXPECT_NEAR(motion.hold.stretch.y, 0.001 * (1 - share), 1e-15);
}

TEST(BlockPush, WhatSlipsIsDraggedByTheCoefficientTimesThePush) {
  const BlockHold hold{.axis = 2, .sign = -1, .depth_m = 0.003, .stretch = {0.03, 0.04, 0}};
  const double share = 1 - std::exp(-kStiffness * 0.02 / kDrag);
  const BlockMotion motion = after(0.5, hold, {}, 0.02, 1);
  expect_near(motion.center, {0.6 * 0.5 * 0.003 * share, 0.8 * 0.5 * 0.003 * share, -0.003 * share},
              1e-15);
  EXPECT_NEAR(norm(motion.hold.stretch), 0.5 * motion.hold.depth_m, 1e-15) << "its foot slips";
}

TEST(BlockPush, OneStepIsAsManyOfAHandThatRests) {
  for (const double friction : {0.0, 0.3, 1.0}) {
    for (const double stretch_m : {0.0005, 0.01}) {
      const BlockHold hold{.axis = 1, .depth_m = 0.003, .stretch = {stretch_m, 0, -stretch_m}};
      expect_near(after(friction, hold, {}, 0.05, 1).center,
                  after(friction, hold, {}, 0.05, 400).center, 1e-12);
    }
  }
}

TEST(BlockPush, AWeightThatPullsItAwayTakesItOffTheHand) {
  const BlockHold hold{.axis = 0, .depth_m = 0.001};
  const BlockMotion motion = after(0, hold, {2, 0, 0}, 0.05, 1);
  const double held_s = kDrag / kStiffness * std::log1p(kStiffness * 0.001 / 2);
  EXPECT_NEAR(motion.center.x, 0.001 + 2 / kDrag * (0.05 - held_s), 1e-6 + 2 / kDrag * held_s);
  EXPECT_EQ(motion.hold.depth_m, 0);
  expect_near(motion.center, after(0, hold, {2, 0, 0}, 0.05, 1000).center, 1e-9);
}

TEST(BlockPush, AWeightThatPressesItOnAHandStopsWhereTheHandHoldsIt) {
  const BlockMotion motion = after(0.5, {.axis = 0, .depth_m = 0.001}, {-1.6, 0, 0}, 5, 100);
  EXPECT_NEAR(motion.hold.depth_m, 1.6 / kStiffness, 1e-12);
}

// Of 1 N that it hangs by, more than sticking holds: it slips as fast at one step a second as at
// thousand. The face does not give way: the wall of the room is behind.
TEST(BlockPush, HeldAgainstAWallItSinksByWhatFrictionDoesNotHold) {
  for (const int steps : {1, 10, 1000}) {
    BlockMotion motion{{0.03, 0, 0}, {.axis = 0, .depth_m = 0.001}};
    for (int i = 0; i < steps; ++i) {
      motion.hold.stretch = {0, 0.5 * 0.001, 0};  // as far as it goes
      motion = push_block(oil(0.5), motion.hold, motion.center, {0, -1, 0}, 1.0 / steps);
    }
    EXPECT_NEAR(motion.center.y, -(1 - 0.5 * kStiffness * 0.001) / kDrag, 1e-3 / kDrag) << steps;
    EXPECT_EQ(motion.center.x, 0.03);
  }
  BlockMotion held{{0.03, 0, 0}, {.axis = 0, .depth_m = 0.003}};
  for (int i = 0; i < 3000; ++i) {
    held = push_block(oil(0.5), held.hold, held.center, {0, -1, 0}, 1e-3);
  }
  EXPECT_NEAR(held.center.y, -1 / kStiffness, 1e-9) << "the way that its foot gives";
}

TEST(BlockPush, ABlockThatNobodyHoldsSinksToTheWall) {
  EXPECT_EQ(sink_block(oil(1), {0.01, 0, 0}, {}, 1), (Position3{0.01, 0, 0}));
  EXPECT_NEAR(sink_block(oil(1), {}, {0, -0.4, 0}, 0.1).y, -0.001, 1e-15);
  EXPECT_EQ(sink_block(oil(1), {}, {0, 0, 90}, 1).z, 0.03);
}

}  // namespace
}  // namespace thimble::world
