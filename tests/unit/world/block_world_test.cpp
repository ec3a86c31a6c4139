#include "daemon/world/block_world.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/unit/world/block_trace.hpp"

namespace thimble::world {
namespace {

constexpr Duration kBlockTick = std::chrono::milliseconds(1);
constexpr double kFace_m = 0.015;

BlockWorld make_block(const BlockScene& scene = {}) { return BlockWorld::create(scene).value(); }

double push_of(double depth_m, Duration dt, double drag = 40) {
  return depth_m * (1 - std::exp(-800 * seconds(dt) / drag));
}

TEST(BlockWorld, RefusesWhatCannotBe) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const BlockScene& scene :
       {BlockScene{0.03, 0.03, 40}, BlockScene{0.09, 0, 40}, BlockScene{0.09, 0.03, 0},
        BlockScene{nan, 0.03, 40}, BlockScene{0.09, 0.03, nan},
        BlockScene{std::numeric_limits<double>::infinity(), 0.03, 40}, BlockScene{.friction = -0.1},
        BlockScene{.friction = 1.1}, BlockScene{.friction = nan},
        BlockScene{.weight = {0, nan, 0}}}) {
    const auto sut = BlockWorld::create(scene);
    ASSERT_FALSE(sut);
    EXPECT_EQ(sut.error().code, Errc::InvalidArgument);
  }
  BlockWorld full = make_block();
  EXPECT_FALSE(full.add_probe({nan, 0, 0}));
  for (std::size_t i = 0; i < kMaxProbes; ++i) EXPECT_TRUE(full.add_probe({0.04, 0, 0}));
  EXPECT_EQ(full.add_probe({0.04, 0, 0}).error().code, Errc::Busy);
}

TEST(BlockWorld, AHandFeelsTheFaceThatItPushesAndTheBlockGivesWay) {
  BlockWorld sut = make_block();
  const ProbeId probe = sut.add_probe({-0.03, 0.002, 0}).value();
  EXPECT_TRUE(sut.move_probe(probe, {-0.02, 0.002, 0}, kBlockTick).planes.empty());
  EXPECT_EQ(sut.block_center(), Position3{});
  const ProbeMotion motion = sut.move_probe(probe, {-0.014, 0.002, 0}, kBlockTick);
  ASSERT_EQ(motion.planes.size(), 1U);
  EXPECT_EQ(motion.planes[0].normal, (Direction3{1, 0, 0}));
  const double moved_m = push_of(0.001, kBlockTick);
  EXPECT_DOUBLE_EQ(motion.planes[0].offset_m, -kFace_m + moved_m);
  EXPECT_DOUBLE_EQ(motion.ghost.x, -kFace_m + moved_m);
  EXPECT_DOUBLE_EQ(motion.ghost.y, 0.002);
  EXPECT_NEAR(sut.block_center()->x, moved_m, 1e-15);
}

TEST(BlockWorld, GoesByTheTimeAndNotByTheRate) {
  BlockWorld slow = make_block();
  BlockWorld fast = make_block();
  const ProbeId of_slow = slow.add_probe({-0.03, 0, 0}).value();
  const ProbeId of_fast = fast.add_probe({-0.03, 0, 0}).value();
  (void)slow.move_probe(of_slow, {-0.005, 0, 0}, std::chrono::milliseconds(20));
  for (int i = 0; i < 160; ++i) {
    (void)fast.move_probe(of_fast, {-0.005, 0, 0}, std::chrono::microseconds(125));
  }
  EXPECT_NEAR(slow.block_center()->x, fast.block_center()->x, 1e-12);
  EXPECT_GT(slow.block_center()->x, 0.003);
}

// Two fingers grasp (thesis 5.2).
TEST(BlockWorld, WhoIsSqueezedStandsAndIsFeltByBoth) {
  BlockWorld sut = make_block();
  const ProbeId left = sut.add_probe({-0.03, 0, 0}).value();
  const ProbeId right = sut.add_probe({0.03, 0, 0}).value();
  for (int i = 0; i < 2000; ++i) {
    const ProbeMotion a = sut.move_probe(left, {-0.012, 0, 0}, kBlockTick);
    const ProbeMotion b = sut.move_probe(right, {0.012, 0, 0}, kBlockTick);
    ASSERT_EQ(a.planes.size(), 1U);
    ASSERT_EQ(b.planes.size(), 1U);
    EXPECT_EQ(b.planes[0].normal, (Direction3{-1, 0, 0}));
  }
  // It moves by their sum: up to the step of who is served last.
  EXPECT_LT(std::abs(sut.block_center()->x), push_of(0.003, kBlockTick));
}

TEST(BlockWorld, HeldBetweenTwoFingersItIsCarried) {
  BlockWorld sut = make_block();
  const ProbeId left = sut.add_probe({-0.03, 0, 0}).value();
  const ProbeId right = sut.add_probe({0.03, 0, 0}).value();
  double at_m = 0;
  for (int i = 0; i < 4000; ++i) {
    if (i > 500 && at_m < 0.02) at_m += 0.00001;
    const ProbeMotion a = sut.move_probe(left, {at_m - 0.012, 0, 0}, kBlockTick);
    const ProbeMotion b = sut.move_probe(right, {at_m + 0.012, 0, 0}, kBlockTick);
    EXPECT_EQ(a.planes.size() + b.planes.size(), 2U) << i;
  }
  EXPECT_NEAR(sut.block_center()->x, 0.02, 0.0002);
}

TEST(BlockWorld, TwoFromOneSideAreTwiceAsFast) {
  BlockWorld alone = make_block();
  BlockWorld both = make_block();
  const ProbeId one = alone.add_probe({-0.03, 0, 0}).value();
  const ProbeId first = both.add_probe({-0.03, 0.005, 0}).value();
  const ProbeId second = both.add_probe({-0.03, -0.005, 0}).value();
  for (int i = 0; i < 20; ++i) {
    // Each leans by the same depth, whatever has moved.
    const double ahead_m = 0.002 - kFace_m;
    (void)alone.move_probe(one, {alone.block_center()->x + ahead_m, 0, 0}, kBlockTick);
    (void)both.move_probe(first, {both.block_center()->x + ahead_m, 0.005, 0}, kBlockTick);
    (void)both.move_probe(second, {both.block_center()->x + ahead_m, -0.005, 0}, kBlockTick);
  }
  EXPECT_NEAR(both.block_center()->x, 2 * alone.block_center()->x, 1e-12);
}

TEST(BlockWorld, AHandIsPushedByWhatAnotherPushes) {
  BlockWorld sut = make_block();
  const ProbeId pusher = sut.add_probe({-0.03, 0, 0}).value();
  const ProbeId other = sut.add_probe({0.02, 0, 0}).value();
  const Position3 rest{0.02, 0, 0};
  EXPECT_TRUE(sut.move_probe(other, rest, kBlockTick).planes.empty());
  for (int i = 0; i < 1000; ++i) (void)sut.move_probe(pusher, {0.005, 0, 0}, kBlockTick);
  EXPECT_NEAR(sut.block_center()->x, 0.02, 1e-4);
  const ProbeMotion pushed = sut.move_probe(other, rest, kBlockTick);
  ASSERT_EQ(pushed.planes.size(), 1U);
  EXPECT_EQ(pushed.planes[0].normal, (Direction3{-1, 0, 0}));
  EXPECT_GT(pushed.ghost.x, rest.x + 0.014);
}

TEST(BlockWorld, StopsAtTheWallAndSoDoHands) {
  BlockWorld sut = make_block();
  const ProbeId probe = sut.add_probe({-0.03, 0, 0}).value();
  for (int i = 0; i < 5000; ++i) (void)sut.move_probe(probe, {0.08, 0, 0}, kBlockTick);
  EXPECT_NEAR(sut.block_center()->x, 0.03, 1e-12);
  const ProbeMotion motion = sut.move_probe(probe, {0.08, 0.06, 0}, kBlockTick);
  EXPECT_EQ(motion.ghost.y, 0.045);
}

TEST(BlockWorld, AHandThatAppearsInItStartsAtItsNearestFace) {
  BlockWorld sut = make_block();
  const ProbeId probe = sut.add_probe({0.001, 0.014, 0}).value();
  const ProbeMotion motion = sut.move_probe(probe, {0.001, 0.016, 0}, kBlockTick);
  EXPECT_EQ(motion.ghost, (Position3{0.001, 0.016, 0}));
  EXPECT_EQ(sut.block_center(), Position3{});
}

TEST(BlockWorld, UnknownProbesAndHandsThatAreNowherePushNothing) {
  BlockWorld sut = make_block();
  const ProbeId probe = sut.add_probe({-0.03, 0, 0}).value();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(sut.move_probe(probe, {nan, 0, 0}, kBlockTick).ghost, (Position3{-0.03, 0, 0}));
  sut.remove_probe(probe);
  EXPECT_EQ(sut.move_probe(probe, {0, 0, 0}, kBlockTick).ghost, Position3{});
  EXPECT_EQ(sut.block_center(), Position3{});
}

// Hands drawn at random; every ghost and the block are where they may be, and what is felt holds.
TEST(BlockWorld, NoGhostIsInItAndItIsInTheRoomWhateverHandsDo) {
  std::mt19937_64 random(419);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int run = 0; run < 40; ++run) {
    const double edge_m = between(0.005, 0.08);
    BlockWorld sut = make_block({0.09, edge_m, between(1, 500)});
    std::vector<ProbeId> probes;
    std::vector<Position3> hands;
    for (int i = 0; i < 4; ++i) {
      hands.push_back({between(-0.06, 0.06), between(-0.06, 0.06), between(-0.06, 0.06)});
      probes.push_back(sut.add_probe(hands.back()).value());
    }
    for (int step = 0; step < 3000; ++step) {
      const std::size_t who = random() % probes.size();
      const double reach_m = random() % 50 == 0 ? 0.08 : 0.002;
      for (std::size_t axis = 0; axis < 3; ++axis) hands[who][axis] += between(-reach_m, reach_m);
      if (norm(hands[who] - Position3{}) > 0.1) hands[who] = {};
      const ProbeMotion motion =
          sut.move_probe(probes[who], hands[who], std::chrono::microseconds(random() % 20000));
      const Position3 center = *sut.block_center();
      bool is_inside = true;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        ASSERT_LE(std::abs(center[axis]) + edge_m / 2, 0.045 + 1e-12);
        ASSERT_LE(std::abs(motion.ghost[axis]), 0.045 + 1e-12);
        is_inside &= std::abs(motion.ghost[axis] - center[axis]) < edge_m / 2 - 1e-12;
      }
      ASSERT_FALSE(is_inside) << run << ' ' << step;
      for (const ContactPlane& plane : motion.planes) {
        EXPECT_GE(dot(plane.normal, hands[who] - Position3{}), plane.offset_m - 1e-12);
        EXPECT_NEAR(dot(plane.normal, motion.ghost - Position3{}), plane.offset_m, 1e-12);
      }
    }
  }
}

// Plain, and with all that it may have: what rubs and what pulls is turned, too.
TEST(BlockWorld, MirroredAndPermutedHandsGiveAMirroredAndPermutedBlock) {
  for (const BlockScene& kind :
       {BlockScene{}, BlockScene{.friction = 0.6, .weight = {0.1, -0.7, 0.3}}}) {
    const auto reference = wander_about_block(kind, 0, 1);
    EXPECT_NE(reference.back(), Position3{});
    for (const std::size_t shift : {0U, 1U, 2U}) {
      EXPECT_EQ(wander_about_block(kind, shift, -1), reference);
      EXPECT_EQ(wander_about_block(kind, shift, 1), reference);
    }
  }
}

}  // namespace
}  // namespace thimble::world
