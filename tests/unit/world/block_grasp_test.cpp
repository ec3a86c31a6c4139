// What friction and a weight make of a block (thesis 5.2, two fingers grasp).
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <random>
#include <vector>

#include "daemon/world/block_world.hpp"

namespace thimble::world {
namespace {

constexpr Duration kGraspTick = std::chrono::milliseconds(1);
constexpr double kGraspFace_m = 0.015;
constexpr double kGraspDrag = 40;

BlockWorld rough_block(double friction, Force3 weight = {}) {
  return BlockWorld::create({.friction = friction, .weight = weight}).value();
}

// Two fingers at its left and right, which lean by `depth_m`.
struct Fingers {
  explicit Fingers(BlockWorld& world)
      : block(world),
        left(world.add_probe({-0.03, 0, 0}).value()),
        right(world.add_probe({0.03, 0, 0}).value()) {}

  void hold(double depth_m, Displacement3 at, Duration dt = kGraspTick) {
    of_left = block.move_probe(left, Position3{depth_m - kGraspFace_m, 0, 0} + at, dt);
    of_right = block.move_probe(right, Position3{kGraspFace_m - depth_m, 0, 0} + at, dt);
  }
  // Squeezes for a second, then both go by `way` in 2 s.
  void carry(double depth_m, Displacement3 way) {
    for (int i = 0; i < 1000; ++i) hold(depth_m, {});
    for (int i = 0; i < 2000; ++i) hold(depth_m, i / 2000.0 * way);
    for (int i = 0; i < 1000; ++i) hold(depth_m, way);
  }

  BlockWorld& block;
  ProbeId left;
  ProbeId right;
  ProbeMotion of_left{};
  ProbeMotion of_right{};
};

TEST(BlockGrasp, TwoFingersThatSqueezeCarryItCrosswise) {
  for (const Displacement3 way : {Displacement3{0, 0.012, 0}, {0, 0, -0.012}, {0, 0.007, 0.007}}) {
    BlockWorld sut = rough_block(0.5);
    Fingers fingers(sut);
    fingers.carry(0.003, way);
    EXPECT_NEAR(norm(*sut.block_center() - (Position3{} + way)), 0, 2e-4);
  }
  BlockWorld smooth = rough_block(0);
  Fingers fingers(smooth);
  fingers.carry(0.003, {0, 0.012, 0});
  EXPECT_EQ(smooth.block_center()->y, 0);
}

// 2·0.5·800 N/m·x: 2.4 N at 3 mm, 0.4 N at 0.5.
TEST(BlockGrasp, TheyLiftItWhileTheySqueezeHardEnough) {
  constexpr double kWeight_newton = 1;
  BlockWorld sut = rough_block(0.5, {0, -kWeight_newton, 0});
  Fingers fingers(sut);
  for (int i = 0; i < 100; ++i) fingers.hold(0.003, {});
  const double caught_m = sut.block_center()->y;
  for (int i = 0; i < 4000; ++i) fingers.hold(0.003, {0, std::min(1.0, i / 2000.0) * 0.02, 0});
  EXPECT_NEAR(sut.block_center()->y, caught_m + 0.02, 1e-3);
  const double lifted_m = sut.block_center()->y;
  for (int i = 0; i < 2000; ++i) fingers.hold(0.003, {0, 0.02, 0});
  EXPECT_NEAR(sut.block_center()->y, lifted_m, 1e-9) << "it does not creep";
  for (int i = 0; i < 500; ++i) fingers.hold(0.0005, {0, 0.02, 0});
  const double slipping_m = sut.block_center()->y;
  for (int i = 0; i < 200; ++i) fingers.hold(0.0005, {0, 0.02, 0});
  EXPECT_NEAR(slipping_m - sut.block_center()->y, (kWeight_newton - 0.4) / kGraspDrag * 0.2, 1e-4);
}

TEST(BlockGrasp, OneFingerAloneCannotLiftIt) {
  BlockWorld sut = rough_block(1, {0, -1, 0});
  const ProbeId finger = sut.add_probe({-0.03, 0, 0}).value();
  double highest_m = -1;
  for (int i = 0; i < 1500; ++i) {
    // It follows the face that gives way, and pulls up.
    const double lean_m = sut.block_center()->x - kGraspFace_m + 0.001;
    (void)sut.move_probe(finger, {lean_m, 1e-5 * i, 0}, kGraspTick);
    if (i > 300) highest_m = std::max(highest_m, sut.block_center()->y);
  }
  EXPECT_LT(highest_m, 0);
  EXPECT_LT(sut.block_center()->y, -0.003);
  EXPECT_GT(sut.block_center()->x, 0.015) << "it is pushed away instead";
}

TEST(BlockGrasp, LetGoItSinksByItsWeightWhateverTheFingersRates) {
  for (const auto& ticks_us : std::vector<std::vector<int>>{
           {1000}, {125, 1000}, {1000, 20'000, 125}, {50'000, 50'000, 1000, 1000}}) {
    BlockWorld sut = rough_block(0.5, {0, 0, -0.8});
    std::vector<ProbeId> probes;
    for (std::size_t i = 0; i < ticks_us.size(); ++i) {
      probes.push_back(sut.add_probe({-0.04, 0.04, 0.04}).value());
    }
    for (int now_us = 0; now_us < 500'000; now_us += 125) {
      for (std::size_t i = 0; i < ticks_us.size(); ++i) {
        if (now_us % ticks_us[i] != 0) continue;
        (void)sut.move_probe(probes[i], {-0.04, 0.04, 0.04},
                             std::chrono::microseconds(ticks_us[i]));
      }
    }
    EXPECT_NEAR(sut.block_center()->z, -0.5 * 0.8 / kGraspDrag, 1e-9);
  }
}

TEST(BlockGrasp, WhoGoesTakesNoShareOfTheTimeWithIt) {
  BlockWorld sut = rough_block(0.5, {0, 0, -0.8});
  const ProbeId gone = sut.add_probe({-0.04, 0, 0}).value();
  const ProbeId stays = sut.add_probe({-0.04, 0, 0}).value();
  sut.remove_probe(gone);
  sut.remove_probe(gone);
  for (int i = 0; i < 100; ++i) (void)sut.move_probe(stays, {-0.04, 0, 0}, kGraspTick);
  EXPECT_NEAR(sut.block_center()->z, -0.1 * 0.8 / kGraspDrag, 1e-12);
}

TEST(BlockGrasp, IsHeldAndCarriedAtAnyRate) {
  for (const int tick_us : {125, 1000, 4000, 20'000, 50'000}) {
    const Duration dt = std::chrono::microseconds(tick_us);
    BlockWorld sut = rough_block(0.5, {0, -1, 0});
    Fingers fingers(sut);
    const int ticks = 1'000'000 / tick_us;
    for (int i = 0; i < ticks; ++i) fingers.hold(0.004, {}, dt);
    const double held_m = sut.block_center()->y;
    EXPECT_NEAR(held_m, -0.5 / 800, 2e-3) << tick_us << ": it sank before they had it";
    for (int i = 0; i < 2 * ticks; ++i) fingers.hold(0.004, {0, 0, 0.01 * i / ticks}, dt);
    EXPECT_NEAR(sut.block_center()->z, 0.02, 1.5e-3) << tick_us;
    EXPECT_NEAR(sut.block_center()->y, held_m, 1e-3) << tick_us;
  }
}

TEST(BlockGrasp, AHandIsToldTheShareOfItsPushThatItDrags) {
  BlockWorld sut = rough_block(0.5, {0, -1, 0});
  Fingers fingers(sut);
  for (int i = 0; i < 3000; ++i) fingers.hold(0.003, {});
  double held_newton = 0;
  for (const auto& [motion, hand_m] :
       {std::pair{fingers.of_left, -0.012}, {fingers.of_right, 0.012}}) {
    ASSERT_EQ(motion.planes.size(), 1U);
    const ContactPlane& plane = motion.planes[0];
    EXPECT_LE(plane.friction, 0.5);
    held_newton += plane.friction * 800 * (plane.normal.x * hand_m - plane.offset_m);
  }
  EXPECT_NEAR(held_newton, 1, 0.02) << "its weight";

  BlockWorld afloat = rough_block(0.5);
  const ProbeId finger = afloat.add_probe({-0.03, 0, 0}).value();
  ProbeMotion motion = afloat.move_probe(finger, {-0.012, 0, 0}, kGraspTick);
  EXPECT_EQ(motion.planes[0].friction, 0) << "nothing was dragged yet";
  motion = afloat.move_probe(finger, {-0.012, 0.02, 0}, kGraspTick);
  EXPECT_TRUE(motion.planes.empty()) << "it is off the face";
  BlockWorld smooth = rough_block(0);
  const ProbeId sliding = smooth.add_probe({-0.03, 0, 0}).value();
  EXPECT_EQ(smooth.move_probe(sliding, {-0.012, 0, 0}, kGraspTick).planes[0].friction, -1)
      << "the arm's own";
}

TEST(BlockGrasp, AFingerThatCameBackSticksAnew) {
  BlockWorld sut = rough_block(1);
  const ProbeId finger = sut.add_probe({-0.03, 0, 0}).value();
  (void)sut.move_probe(finger, {-0.014, 0, 0}, kGraspTick);
  (void)sut.move_probe(finger, {-0.02, 0, 0}, kGraspTick);
  (void)sut.move_probe(finger, {-0.02, 0.01, 0}, kGraspTick);
  (void)sut.move_probe(finger, {-0.013, 0.01, 0}, kGraspTick);
  EXPECT_EQ(sut.block_center()->y, 0) << "what it did in the air is not held against it";
}

// Hands drawn at random; every ghost and the block are where they may be.
TEST(BlockGrasp, NoGhostIsInItWhateverPullsAndRubs) {
  std::mt19937_64 random(421);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int run = 0; run < 40; ++run) {
    const double edge_m = between(0.005, 0.08);
    BlockWorld sut = BlockWorld::create({.edge_m = edge_m,
                                         .drag_newton_s_per_m = between(1, 500),
                                         .friction = between(0, 1),
                                         .weight = {between(-5, 5), between(-5, 5), 0}})
                         .value();
    std::array<Position3, 4> hands{};
    std::array<ProbeId, 4> probes{};
    for (ProbeId& probe : probes) probe = sut.add_probe({0.04, between(-0.04, 0.04), 0}).value();
    for (int step = 0; step < 3000; ++step) {
      const std::size_t who = random() % probes.size();
      const double reach_m = random() % 50 == 0 ? 0.08 : 0.002;
      for (std::size_t axis = 0; axis < 3; ++axis) hands[who][axis] += between(-reach_m, reach_m);
      if (norm(hands[who] - Position3{}) > 0.1) hands[who] = {};
      const ProbeMotion motion =
          sut.move_probe(probes[who], hands[who], std::chrono::microseconds(random() % 50'000));
      const Position3 center = *sut.block_center();
      bool is_inside = true;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        ASSERT_LE(std::abs(center[axis]) + edge_m / 2, 0.045 + 1e-12);
        ASSERT_LE(std::abs(motion.ghost[axis]), 0.045 + 1e-12);
        is_inside &= std::abs(motion.ghost[axis] - center[axis]) < edge_m / 2 - 1e-12;
      }
      ASSERT_FALSE(is_inside) << run << ' ' << step;
      for (const ContactPlane& plane : motion.planes) {
        EXPECT_LE(plane.friction, 1);
        EXPECT_NEAR(dot(plane.normal, motion.ghost - Position3{}), plane.offset_m, 1e-12);
      }
    }
  }
}

}  // namespace
}  // namespace thimble::world
