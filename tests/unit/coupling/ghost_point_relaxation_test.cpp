#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "arm_bench.hpp"

namespace thimble::coupling {
namespace {

using testing::ArmBench;
using testing::kPlusX;
using testing::kPlusY;
using testing::wall;

// Pushes the frame to about (-dx, -dy, 0) and lets go of both walls.
ArmOutput displace(ArmBench& bench, double dx_m, double dy_m) {
  bench.told({0, 0, 0}, {});
  bench.told({dx_m, dy_m, 0}, {wall(kPlusX, -0.0005), wall(kPlusY, -0.0005)});
  bench.session += 1;  // a restart voids the walls, barriers included
  return bench.told({dx_m, dy_m, 0}, {});
}

// Defect 14.
TEST(GhostPointRelaxation, FrameReturnsInAStraightLineAtItsSpeed) {
  ArmBench bench;
  const ArmOutput first = displace(bench, 0.020, 0.010);
  const Displacement3 start = first.offset;
  for (int i = 1; i <= 100; ++i) {
    const ArmOutput out = bench.told({}, {});
    EXPECT_NEAR(norm(out.offset), norm(start) - i * 0.025e-3, 1e-12);
    EXPECT_NEAR(out.offset.x * start.y, out.offset.y * start.x, 1e-15);
  }
}

TEST(GhostPointRelaxation, FrameReturnsAllTheWayWithoutADeadBand) {
  ArmBench bench;
  displace(bench, 0.001, 0.0005);
  ArmOutput out{};
  for (int i = 0; i < 100; ++i) out = bench.told({}, {});
  EXPECT_EQ(out.offset, Displacement3{});
}

TEST(GhostPointRelaxation, FrameNeverPressesAHeldWallDeeper) {
  ArmBench bench;
  const ConstraintPlane plane = wall(kPlusX, 0.015);
  const ArmOutput first = bench.told({0.030, 0, 0}, {plane});
  for (int i = 0; i < 500; ++i) {
    EXPECT_EQ(bench.told({0.030, 0, 0}, {plane}).offset, first.offset);
  }
}

TEST(GhostPointRelaxation, FrameSlidesAlongTheWallThatBlocksIt) {
  ArmBench bench;
  displace(bench, 0.001, 0.010);
  const ConstraintPlane plane = wall(kPlusX, 0.015);
  const ArmOutput first = bench.told({0.030, 0, 0}, {plane});
  ArmOutput out{};
  for (int i = 0; i < 1500; ++i) out = bench.told({0.030, 0, 0}, {plane});
  EXPECT_NEAR(out.offset.x, first.offset.x, 1e-12);
  EXPECT_NEAR(out.offset.y, 0, 2e-5);
}

TEST(GhostPointRelaxation, FrameStopsShortOfAHeldWall) {
  ArmBench bench;
  const ConstraintPlane plane = wall(kPlusX, 0.015);
  bench.told({0.030, 0, 0}, {plane});
  ArmOutput out{};
  for (int i = 0; i < 2000; ++i) {
    out = bench.told({0.028, 0, 0}, {plane});
    ASSERT_EQ(out.force, Force3{});
  }
  EXPECT_NEAR(out.sample.hand.x, 0.015, 2e-6);
}

// Decision 0052: else a resting finger would be tapped by the returning wall for ever.
TEST(GhostPointRelaxation, FrameStopsShortOfAWallThatTheWorldNoLongerNames) {
  ArmBench bench;
  bench.told({0.030, 0, 0}, {wall(kPlusX, 0.015)});
  ArmOutput out{};
  for (int i = 0; i < 2000; ++i) out = bench.told({0.028, 0, 0}, {});
  EXPECT_NEAR(out.sample.hand.x, 0.015, 2e-6);
  EXPECT_EQ(out.force, Force3{});
}

TEST(GhostPointRelaxation, HandPastARememberedWallDisprovesIt) {
  ArmBench bench;
  bench.told({0.030, 0, 0}, {wall(kPlusX, 0.015)});
  bench.told({0.028, 0, 0}, {});
  bench.told({0.040, 0, 0}, {});
  ArmOutput out{};
  for (int i = 0; i < 2000; ++i) out = bench.told({0.028, 0, 0}, {});
  EXPECT_EQ(out.offset, Displacement3{});
}

TEST(GhostPointRelaxation, ObliqueWallsAreNotPressedDeeperEither) {
  const std::vector<Direction3> lefts{{-0.28, 0.96, 0}, {-0.96, 0.28, 0}};
  for (const Direction3 left : lefts) {
    const Direction3 right{-left.x, left.y, 0};
    ArmBench bench;
    const std::vector<ConstraintPlane> wedge{wall(left, 0.010), wall(right, 0.010)};
    ArmOutput out = bench.told({0.001, 0.060, 0.004}, wedge);
    EXPECT_LT(out.offset.y, 0);
    double left_m = dot(left, out.sample.hand);
    double right_m = dot(right, out.sample.hand);
    for (int i = 0; i < 500; ++i) {
      out = bench.told({0.001, 0.060, 0.004}, wedge);
      EXPECT_LE(dot(left, out.sample.hand), std::max(left_m, 0.010) + 2e-9);
      EXPECT_LE(dot(right, out.sample.hand), std::max(right_m, 0.010) + 2e-9);
      left_m = dot(left, out.sample.hand);
      right_m = dot(right, out.sample.hand);
    }
  }
}

TEST(GhostPointRelaxation, ArrivingAtAWallIsNoContact) {
  GhostPointSettings settings;
  settings.relaxation_m_per_s = 1;
  for (int trial = 0; trial < 200; ++trial) {
    ArmBench bench(settings);
    const double angle = 0.0031 * trial;
    const Direction3 normal{std::cos(angle), std::sin(angle), 0};
    const ConstraintPlane plane = wall(normal, 0.0149 + 3.7e-6 * trial);
    bench.told({0.0301 * normal.x, 0.0301 * normal.y, 0}, {plane});
    const Position3 tip{0.0277 * normal.x, 0.0277 * normal.y, 0};
    std::uint32_t contacts = 0;
    for (int i = 0; i < 20; ++i) contacts += bench.told(tip, {plane}).new_contacts;
    EXPECT_EQ(contacts + bench.sut.counters().redetections, 0U) << trial;
  }
}

TEST(GhostPointRelaxation, StalledServoDoesNotMoveTheFrameAtOnce) {
  ArmBench bench;
  const ArmOutput before = displace(bench, 0.020, 0);
  ConstraintSet set;
  set.session = bench.session;
  ArmInput late{.now = bench.now + std::chrono::seconds(1), .dt = std::chrono::seconds(1)};
  late.fresh = &set;
  const ArmOutput after = bench.sut.step(late);
  EXPECT_LE(norm(after.offset - before.offset), 0.025 * 0.020 + 1e-12);
}

// Permuted worlds give permuted traces to the last bit, so the length of the way must not
// depend on the order of the axes.
TEST(GhostPointRelaxation, AxesAreAlikeToTheLastBit) {
  GhostPointSettings settings;
  settings.relaxation_m_per_s = 3;
  for (int trial = 0; trial < 500; ++trial) {
    const Displacement3 way{0.0101 + 0.00007 * trial, 0.0203 + 0.00003 * trial, 0.0307};
    std::vector<Displacement3> ends;
    for (const std::size_t turn : {0U, 1U, 2U}) {
      ArmBench bench(settings);
      Position3 tip;
      std::vector<ConstraintPlane> corner;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        tip[(axis + turn) % 3] = way[axis];
        Direction3 normal{};
        normal[axis] = 1;
        corner.push_back(wall(normal, 0));
      }
      bench.told(tip, corner);
      bench.session = 2;
      ArmOutput out{};
      for (int i = 0; i < 5; ++i) out = bench.told({}, {});
      ends.push_back({out.offset[turn], out.offset[(1 + turn) % 3], out.offset[(2 + turn) % 3]});
    }
    EXPECT_EQ(ends[1], ends[0]);
    EXPECT_EQ(ends[2], ends[0]);
  }
}

}  // namespace
}  // namespace thimble::coupling
