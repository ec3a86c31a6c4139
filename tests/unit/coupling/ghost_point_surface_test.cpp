#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "arm_bench.hpp"
#include "daemon/coupling/ghost_point_arm.hpp"

namespace thimble::coupling {
namespace {

using testing::ArmBench;
using testing::kPlusX;
using testing::kPlusY;
using testing::wall;
using testing::without_spring;

constexpr double kWall_m = 0.015;
constexpr double kHysteresis_m = 0.0005;

// Else a world that repeats it holds the arm at its peak.
TEST(GhostPointSurface, AWallBeyondTheBoundOfTheFrameIsFeltAsOneJustTouched) {
  for (const double offset_m : {-0.3, -1.0, -1e5}) {
    ArmBench bench(without_spring());
    for (int i = 0; i < 300; ++i) {
      const ArmOutput out = bench.told({}, {wall(kPlusX, offset_m), wall(kPlusY, offset_m)});
      ASSERT_LE(norm(out.force), std::sqrt(2.0) * 800 * kHysteresis_m + 1e-6) << offset_m;
    }
    const ArmOutput in = bench.told({0.001, 0, 0}, {wall(kPlusX, offset_m)});
    EXPECT_NEAR(in.force.x, -800 * (0.001 + kHysteresis_m), 1e-6) << "a wall all the same";
    EXPECT_EQ(bench.told({-0.001, 0, 0}, {wall(kPlusX, offset_m)}).force, Force3{});
  }
}

TEST(GhostPointSurface, AWallBeyondTheBoundThatWasLeftIsAnyWallAgain) {
  ArmBench bench(without_spring());
  bench.told({}, {wall(kPlusX, -1)});
  bench.told({}, {wall(kPlusX, 1)});
  bench.alone({-0.01, 0, 0});
  bench.told({}, {wall(kPlusX, 0.002)});
  const ArmOutput out = bench.alone({0.253, 0, 0});
  EXPECT_NEAR(out.force.x, -800 * (out.sample.hand.x - 0.002), 1e-9);
}

TEST(GhostPointSurface, RubbingOverStripesWalksNeitherTheFrameNorTheFinger) {
  ArmBench bench(without_spring());
  ConstraintPlane soft = wall(kPlusX, kWall_m);
  soft.surface.stiffness = {200};
  ConstraintPlane hard = soft;
  hard.surface.stiffness = {800};
  const Position3 tip{kWall_m + 0.004, 0, 0};
  bench.told({kWall_m, 0, 0}, {soft});
  for (int i = 0; i < 1000; ++i) {
    for (const ConstraintPlane& stripe : {hard, soft}) {
      const ArmOutput out = bench.told(tip, {stripe});
      ASSERT_EQ(out.offset, Displacement3{});
      ASSERT_NEAR(out.force.x, -0.8, 1e-6);
    }
  }
}

TEST(GhostPointSurface, SurfaceOfThePlaneOverridesTheArmsDefaults) {
  ArmBench bench;
  ConstraintPlane soft = wall(kPlusX, kWall_m);
  soft.surface = {.stiffness = {200}, .damping = {0}};
  bench.told({0.010, 0, 0}, {soft});
  EXPECT_NEAR(bench.alone({0.016, 0, 0}, {0.2, 0, 0}).force.x, -0.2, 1e-9);
}

TEST(GhostPointSurface, SurfaceBeyondTheCeilingIsClipped) {
  ArmBench bench;
  ConstraintPlane hard = wall(kPlusX, kWall_m);
  hard.surface = {.stiffness = {std::numeric_limits<double>::infinity()}, .damping = {1e9}};
  bench.told({0.010, 0, 0}, {hard});
  EXPECT_NEAR(bench.alone({0.0151, 0, 0}, {0.1, 0, 0}).force.x, -(0.3 + 2.0), 1e-9);
}

TEST(GhostPointSurface, SurfaceThatHardensUnderTheFingerGivesNoJump) {
  ArmBench bench(without_spring());
  ConstraintPlane plane = wall(kPlusX, kWall_m);
  plane.surface.stiffness = {200};
  bench.told({kWall_m, 0, 0}, {plane});
  const double before = bench.alone({kWall_m + 0.004, 0, 0}).force.x;
  plane.surface.stiffness = {800};
  EXPECT_NEAR(bench.told({kWall_m + 0.004, 0, 0}, {plane}).force.x, before, 1e-9);
}

}  // namespace
}  // namespace thimble::coupling
