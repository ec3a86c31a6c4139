#include "daemon/coupling/ghost_point_arm.hpp"
#include "daemon/coupling/told_planes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "arm_bench.hpp"

namespace thimble::coupling {
namespace {

using testing::ArmBench;
using testing::kMinusX;
using testing::kPlusX;
using testing::kPlusY;
using testing::wall;
using testing::without_spring;

constexpr double kWall_m = 0.015;
constexpr double kHysteresis_m = 0.0005;

TEST(GhostPointArm, FeelsNothingInFreeSpace) {
  ArmBench bench;
  const ArmOutput out = bench.told({0.01, 0.02, 0.03}, {});
  EXPECT_EQ(out.force, Force3{});
  EXPECT_EQ(out.offset, Displacement3{});
  EXPECT_FALSE(out.is_in_contact);
  EXPECT_EQ(out.sample.hand, (Position3{0.01, 0.02, 0.03}));
}

TEST(GhostPointArm, EverySampleSaysHowOftenItWasReset) {
  ArmBench bench;
  for (std::uint32_t resets = 1; resets <= 3; ++resets) {
    EXPECT_EQ(bench.alone({}).sample.restart, resets);
    EXPECT_EQ(bench.alone({std::nan(""), 0, 0}).sample.restart, resets);
    bench.sut.reset(bench.now, {});
  }
}

// teleop.md 7, defect 1: the sign of the hysteresis.
TEST(GhostPointArm, LateWallLeavesTheFingerHysteresisInsideOnBothSides) {
  for (const double sign : {1.0, -1.0}) {
    ArmBench bench;
    const ArmOutput out = bench.told({sign * 0.020, 0, 0}, {wall({sign, 0, 0}, kWall_m)});
    EXPECT_NEAR(sign * out.sample.hand.x - kWall_m, kHysteresis_m, 1e-12);
    EXPECT_NEAR(sign * out.force.x, -800 * kHysteresis_m, 1e-9);
    EXPECT_EQ(out.new_contacts, 1U);
    EXPECT_TRUE(out.is_in_contact);
  }
}

TEST(GhostPointArm, LateObliqueWallShiftsTheFrameAlongItsNormalOnly) {
  const Direction3 normal{0.6, 0.8, 0};
  ArmBench bench;
  const ArmOutput out = bench.told({0.02, 0.02, 0.01}, {wall(normal, kWall_m)});
  EXPECT_NEAR(dot(normal, out.sample.hand) - kWall_m, kHysteresis_m, 1e-12);
  EXPECT_NEAR(dot(Direction3{-0.8, 0.6, 0}, out.offset), 0, 1e-12);
  EXPECT_EQ(out.offset.z, 0);
}

TEST(GhostPointArm, AbsurdPlanesMoveTheFrameByNoMoreThanItsBound) {
  const GhostPointSettings settings;
  for (const double offset_m : {-10.0, -1.0, -0.3, -1e5}) {
    ArmBench bench;
    const ArmOutput one = bench.told({}, {wall(kPlusX, offset_m)});
    EXPECT_NEAR(one.offset.x, -settings.max_offset_m, 1e-12) << offset_m;
    const ArmOutput corner = bench.told(
        {}, {wall(kPlusX, offset_m), wall(kPlusY, offset_m), wall({0, 0, -1}, offset_m)});
    EXPECT_LE(norm(corner.offset), settings.max_offset_m + 1e-12);
    EXPECT_LT(corner.force.x, 0);
    EXPECT_TRUE(is_finite(corner.force));
    ArmOutput out{};
    for (int i = 0; i < 100; ++i) {
      const double sign = i % 2 == 0 ? 1 : -1;
      out = bench.told({0.01 * sign, 0, 0}, {wall({sign, 0, 0}, offset_m), wall(kPlusY, -10)});
      ASSERT_LE(norm(out.offset), settings.max_offset_m + 1e-12);
      ASSERT_TRUE(is_finite(out.sample.hand));
    }
    for (int i = 0; i < 11000; ++i) out = bench.told({}, {wall(kPlusX, 10)});
    EXPECT_EQ(out.offset, Displacement3{}) << "comes back at 25 mm/s";
  }
}

TEST(GhostPointArm, TheBoundOfTheFrameIsASetting) {
  GhostPointSettings settings;
  settings.max_offset_m = 0.010;
  ArmBench near(settings);
  EXPECT_NEAR(near.told({0.020, 0, 0}, {wall(kPlusX, 0.015)}).offset.x, -0.0045, 1e-12);
  ArmBench far(settings);
  EXPECT_NEAR(far.told({0.030, 0, 0}, {wall(kPlusX, 0.015)}).offset.x, -0.010, 1e-12);
}

TEST(GhostPointArm, CornerShiftsTheFrameOnBothAxes) {
  ArmBench bench;
  const ArmOutput out =
      bench.told({0.020, -0.018, 0}, {wall(kPlusX, kWall_m), wall({0, -1, 0}, kWall_m)});
  EXPECT_NEAR(out.sample.hand.x, kWall_m + kHysteresis_m, 1e-12);
  EXPECT_NEAR(out.sample.hand.y, -kWall_m - kHysteresis_m, 1e-12);
  EXPECT_EQ(out.new_contacts, 2U);
}

TEST(GhostPointArm, WallWithinHysteresisLeavesTheFrameAlone) {
  ArmBench bench;
  const ArmOutput out = bench.told({kWall_m + 0.0004, 0, 0}, {wall(kPlusX, kWall_m)});
  EXPECT_EQ(out.offset, Displacement3{});
  EXPECT_NEAR(out.force.x, -0.32, 1e-9);
}

TEST(GhostPointArm, KnownWallPushesBackWithItsStiffness) {
  ArmBench bench(without_spring());
  bench.told({0.010, 0, 0}, {wall(kPlusX, kWall_m)});
  const ArmOutput out = bench.alone({kWall_m + 0.003, 0, 0});
  EXPECT_NEAR(out.force.x, -2.4, 1e-9);
  EXPECT_EQ(out.offset, Displacement3{});
}

// Defect 29: a fixed half millimetre would be cells deep in a fine world.
TEST(GhostPointArm, HysteresisIsAtMostAQuarterCell) {
  GhostPointSettings settings;
  settings.cell_m = 0.0012;
  EXPECT_DOUBLE_EQ(effective_hysteresis_m(settings.hysteresis_m, settings.cell_m), 0.0003);
  settings.cell_m = 0.030;
  EXPECT_DOUBLE_EQ(effective_hysteresis_m(settings.hysteresis_m, settings.cell_m), 0.0005);
  settings.cell_m = 0.0012;
  ArmBench bench(settings);
  const ArmOutput out = bench.told({0.020, 0, 0}, {wall(kPlusX, kWall_m)});
  EXPECT_NEAR(out.sample.hand.x - kWall_m, 0.0003, 1e-12);
}

// Defect 9: sliding over a step, or a piece that moves, is felt without a kick.
TEST(GhostPointArm, PressedWallThatMovesCarriesTheFrameAlong) {
  ArmBench bench(without_spring());
  bench.told({kWall_m, 0, 0}, {wall(kPlusX, kWall_m)});
  const ArmOutput before = bench.alone({kWall_m + 0.002, 0, 0});
  const ArmOutput after = bench.told({kWall_m + 0.002, 0, 0}, {wall(kPlusX, kWall_m - 0.030)});
  EXPECT_NEAR(after.force.x, before.force.x, 1e-9);
  EXPECT_NEAR(after.offset.x, -0.030, 1e-9);
  EXPECT_EQ(after.new_contacts, 0U);
}

TEST(GhostPointArm, PressedWallThatGivesWayReleasesTheFinger) {
  ArmBench bench(without_spring());
  bench.told({kWall_m, 0, 0}, {wall(kPlusX, kWall_m)});
  bench.alone({kWall_m + 0.002, 0, 0});
  const ArmOutput out = bench.told({kWall_m + 0.002, 0, 0}, {wall(kPlusX, kWall_m + 0.001)});
  EXPECT_NEAR(out.force.x, -0.8, 1e-9);
  EXPECT_EQ(out.offset, Displacement3{});
}

// Defect 17.
TEST(GhostPointArm, RestartedWorldGivesNoJump) {
  ArmBench bench(without_spring());
  bench.told({kWall_m, 0, 0}, {wall(kPlusX, kWall_m)});
  const ArmOutput before = bench.alone({kWall_m + 0.002, 0, 0});
  bench.session = 2;
  const ArmOutput after = bench.told({kWall_m + 0.002, 0, 0}, {wall(kPlusX, kWall_m - 0.001)});
  EXPECT_NEAR(after.force.x, before.force.x, 1e-9);
}

TEST(GhostPointArm, AConstraintHoldsUntilTheNextReplyAndNoLonger) {
  ArmBench bench;
  bench.told({kWall_m, 0, 0}, {wall(kPlusX, kWall_m)});
  const Position3 hand{kWall_m + 0.0004, 0, 0};
  for (int i = 0; i < 10; ++i) EXPECT_LT(bench.alone(hand).force.x, -0.3);
  EXPECT_EQ(bench.told(hand, {wall(kPlusY, kWall_m)}).force, Force3{});
  EXPECT_EQ(bench.alone(hand).force, Force3{});
}

TEST(GhostPointArm, RestartedWorldVoidsThePlanesItDoesNotRepeat) {
  ArmBench bench;
  bench.told({0.010, 0, 0}, {wall(kPlusX, kWall_m)});
  bench.session = 2;
  bench.told({0.010, 0, 0}, {});
  EXPECT_EQ(bench.alone({0.030, 0, 0}).force, Force3{});
}

// Defect 10: a plane that went and came back within one servo tick is a new plane.
TEST(GhostPointArm, PlaneThatReturnsElsewhereCountsAsNew) {
  ArmBench bench;
  bench.told({0.010, 0, 0}, {wall(kPlusX, kWall_m)});
  const ArmOutput out = bench.told({0.014, 0, 0}, {wall(kPlusX, 0.005)});
  EXPECT_NEAR(out.sample.hand.x, 0.005 + kHysteresis_m, 1e-12);
}

// Defect 12.
TEST(GhostPointArm, LeavingFastNeverPullsTheFingerBack) {
  ArmBench bench;
  bench.told({0.010, 0, 0}, {wall(kPlusX, kWall_m)});
  const ArmOutput out = bench.alone({kWall_m + 0.0001, 0, 0}, {-1.0, 0, 0});
  EXPECT_EQ(out.force, Force3{});
}

TEST(GhostPointArm, DampingCountsOnlyInsideTheWall) {
  ArmBench bench;
  bench.told({0.010, 0, 0}, {wall(kPlusX, kWall_m)});
  EXPECT_EQ(bench.alone({0.0149, 0, 0}, {0.2, 0, 0}).force, Force3{});
  EXPECT_NEAR(bench.alone({0.016, 0, 0}, {0.2, 0, 0}).force.x, -(0.8 + 1.0), 1e-9);
}

// Defect 13.
TEST(GhostPointArm, CoordinateSpringRampsInOverATenthOfASecond) {
  ArmBench bench;
  const ConstraintPlane plane = wall(kPlusX, kWall_m);
  bench.told({0.0355, 0, 0}, {plane});
  const Position3 tip{0.0395, 0, 0};  // 4.5 mm deep in a wall 20 mm away from its place
  const double wall_newton = 3.6;
  EXPECT_NEAR(bench.told(tip, {plane}).force.x, -wall_newton - 0.01 * 50 * 0.020, 1e-6);
  for (int i = 0; i < 49; ++i) bench.told(tip, {plane});
  EXPECT_NEAR(bench.told(tip, {plane}).force.x, -wall_newton - 0.51 * 50 * 0.020, 1e-6);
  for (int i = 0; i < 100; ++i) bench.told(tip, {plane});
  EXPECT_NEAR(bench.told(tip, {plane}).force.x, -wall_newton - 50 * 0.020, 1e-6);
}

// Decision 0055: else a light hand is thrown out and caught again for ever.
TEST(GhostPointArm, CoordinateSpringAddsNoMoreThanHalfTheWall) {
  ArmBench bench;
  const ConstraintPlane plane = wall(kPlusX, kWall_m);
  bench.told({0.0355, 0, 0}, {plane});
  ArmOutput out{};
  for (int i = 0; i < 200; ++i) out = bench.told({0.0352, 0, 0}, {plane});
  EXPECT_NEAR(out.force.x, -1.5 * 800 * 0.0002, 1e-9);
}

TEST(GhostPointArm, CoordinateSpringStartsAgainWithEachContact) {
  ArmBench bench;
  const ConstraintPlane plane = wall(kPlusX, kWall_m);
  bench.told({0.0355, 0, 0}, {plane});
  for (int i = 0; i < 200; ++i) bench.told({0.0395, 0, 0}, {plane});
  bench.told({0.0349, 0, 0}, {plane});
  EXPECT_NEAR(bench.told({0.0395, 0, 0}, {plane}).force.x, -3.6, 0.05);
}

TEST(GhostPointArm, OffsetLeftFromTheOppositeWallNeverDrawsIntoThisOne) {
  GhostPointSettings settings;
  settings.relaxation_m_per_s = 0;
  ArmBench bench(settings);
  bench.told({-0.030, 0, 0}, {wall(kMinusX, kWall_m)});
  ArmOutput out{};
  for (int i = 0; i < 200; ++i) out = bench.told({0.001, 0, 0}, {wall(kPlusX, kWall_m)});
  EXPECT_NEAR(out.offset.x, 0.0145, 1e-9);
  EXPECT_NEAR(out.force.x, -800 * 0.0005, 1e-9);
}

TEST(GhostPointArm, CoordinateSpringGrowsSmoothlyWhenAPressedWallJumps) {
  ArmBench bench;
  const Position3 tip{kWall_m + 0.002, 0, 0};
  bench.told({kWall_m, 0, 0}, {wall(kPlusX, kWall_m)});
  for (int i = 0; i < 150; ++i) bench.told(tip, {wall(kPlusX, kWall_m)});
  const double before = bench.told(tip, {wall(kPlusX, kWall_m)}).force.x;
  EXPECT_NEAR(bench.told(tip, {wall(kPlusX, kWall_m - 0.030)}).force.x, before, 0.02);
}

TEST(GhostPointArm, CoordinateSpringThatIsFeltIsNotLostWhenAPressedWallJumps) {
  ArmBench bench;
  const ConstraintPlane plane = wall(kPlusX, kWall_m);
  bench.told({0.0355, 0, 0}, {plane});
  const Position3 tip{0.0395, 0, 0};
  double before = 0;
  for (int i = 0; i < 200; ++i) before = bench.told(tip, {plane}).force.x;
  EXPECT_LT(before, -4.5);
  EXPECT_NEAR(bench.told(tip, {wall(kPlusX, kWall_m - 0.010)}).force.x, before, 0.02);
}

// 8 mm deep at an offset of 5 mm it may not show all of it; then another face shifts the frame by
// 10 mm more, and it may (decision 0057).
TEST(GhostPointArm, CoordinateSpringThatWaitedForItsBudgetGrowsNoFasterThanAnyOther) {
  ArmBench bench;
  const ConstraintPlane first = wall(kPlusX, kWall_m);
  bench.told({kWall_m + 0.0055, 0, 0}, {first});
  const Position3 tip{kWall_m + 0.013, 0, 0};
  ArmOutput out{};
  for (int i = 0; i < 300; ++i) out = bench.told(tip, {first});
  const double wall_newton = 800 * 0.008;
  EXPECT_LT(-out.force.x - wall_newton, 0.9 * 50 * 0.005);
  double last_newton = out.force.x;
  for (int i = 0; i < 300; ++i) {
    out = bench.told(tip, {first, wall(kPlusY, -0.0105)});
    EXPECT_LE(last_newton - out.force.x, 0.011 * 50 * 0.005) << i;
    last_newton = out.force.x;
  }
  EXPECT_NEAR(-out.force.x - wall_newton, 50 * 0.005, 1e-6);
}

// A ball turns its normal under the sliding finger at every reply.
TEST(GhostPointArm, CurvedWallKeepsItsForceWhileTheFingerSlides) {
  ArmBench bench(without_spring());
  const auto tangent = [](double angle) {
    return wall({std::cos(angle), std::sin(angle), 0}, kWall_m);
  };
  bench.told({kWall_m, 0, 0}, {tangent(0)});
  ArmOutput out = bench.alone({kWall_m + 0.003, 0, 0});
  EXPECT_NEAR(norm(out.force), 2.4, 1e-9);
  for (int i = 1; i <= 100; ++i) {
    const double angle = 0.005 * i;
    const double radius_m = kWall_m + 0.003;
    const Position3 tip{radius_m * std::cos(angle), radius_m * std::sin(angle), 0};
    out = bench.told(tip, {tangent(angle)});
    EXPECT_NEAR(norm(out.force), 2.4, 0.05) << i;
    EXPECT_EQ(out.new_contacts, 0U);
  }
}

TEST(GhostPointArm, UnsoundPlanesAreCountedAndNeverFelt) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  ArmBench bench;
  const ArmOutput out =
      bench.told({0.020, 0, 0}, {wall({nan, 0, 0}, 0), wall(kPlusX, nan), wall(kPlusX, -infinity),
                                 wall({2, 0, 0}, 0), wall({0, 0, 0}, -1), wall({1e300, 0, 0}, 0),
                                 wall(kPlusX, -1e30), wall(kPlusY, 0.001)});
  EXPECT_EQ(out.force, Force3{});
  EXPECT_EQ(out.sample.hand, (Position3{0.020, 0, 0}));
  EXPECT_EQ(bench.sut.counters().rejected_planes, 7U);
}

TEST(GhostPointArm, TightestOfParallelPlanesConstrains) {
  ArmBench bench;
  const ArmOutput out =
      bench.told({0.020, 0, 0}, {wall(kPlusX, 0.018), wall(kPlusX, 0.012), wall(kPlusX, 0.016)});
  EXPECT_NEAR(out.sample.hand.x, 0.012 + kHysteresis_m, 1e-12);
  EXPECT_EQ(out.new_contacts, 1U);
}

TEST(GhostPointArm, StateThatIsNotFiniteGivesAForceThatIsNotFiniteAndNoMemory) {
  ArmBench bench;
  bench.told({0.020, 0, 0}, {wall(kPlusX, kWall_m)});
  const ArmOutput good = bench.alone({0.020, 0, 0});
  for (const bool is_tip : {true, false}) {
    const double nan = std::nan("");
    const ArmOutput bad =
        is_tip ? bench.alone({nan, 0, 0}) : bench.alone({0.020, 0, 0}, {0, nan, 0});
    EXPECT_FALSE(is_finite(bad.force));
    EXPECT_EQ(bad.sample.hand, good.sample.hand);
    EXPECT_EQ(bad.sample.velocity, Velocity3{});
    const ArmOutput again = bench.alone({0.020, 0, 0});
    EXPECT_EQ(again.offset, good.offset);
    EXPECT_TRUE(is_finite(again.force));
  }
}

TEST(GhostPointArm, ARestartAtNoPlaceTellsTheWorldOfAPlaceThatThereIs) {
  ArmBench bench;
  bench.alone({0.020, 0, 0});
  bench.sut.reset(bench.now, {std::nan(""), 0, 0});
  const ArmOutput out = bench.alone({std::nan(""), 0, 0});
  EXPECT_EQ(out.sample.hand, Position3{});
  EXPECT_EQ(bench.alone({0.010, 0, 0}).sample.hand, (Position3{0.010, 0, 0}));
}

TEST(GhostPointArm, ResetRestartsTheGhostAtTheHand) {
  ArmBench bench;
  bench.told({0.020, 0, 0}, {wall(kPlusX, kWall_m)});
  bench.sut.reset(bench.now, {0.020, 0, 0});
  const ArmOutput out = bench.alone({0.020, 0, 0});
  EXPECT_EQ(out.force, Force3{});
  EXPECT_EQ(out.offset, Displacement3{});
  EXPECT_EQ(out.sample.hand, (Position3{0.020, 0, 0}));
  EXPECT_EQ(out.sample.applied_reply, 0U);
}

// Defect 8: what is sent already carries the reply it was moved by.
TEST(GhostPointArm, SampleTellsTheReplyItWasShiftedBy) {
  ArmBench bench;
  bench.told({0.010, 0, 0}, {});
  const ArmOutput out = bench.told({0.020, 0, 0}, {wall(kPlusX, kWall_m)}, {0.1, 0, 0});
  EXPECT_EQ(out.sample.applied_reply, 2U);
  EXPECT_EQ(out.sample.sequence, 2U);
  EXPECT_EQ(out.sample.sampled_at, bench.now);
  EXPECT_EQ(out.sample.velocity, (Velocity3{0.1, 0, 0}));
  EXPECT_EQ(out.sample.hand, (Position3{0.020, 0, 0} + out.offset));
}

// Decision 0051.
TEST(GhostPointArm, ChatterWithinTheGuardIsOneContact) {
  ArmBench bench;
  const ConstraintPlane plane = wall(kPlusX, kWall_m);
  std::uint32_t contacts = 0;
  for (int i = 0; i < 20; ++i) {
    contacts += bench.told({kWall_m + 0.0003, 0, 0}, {plane}).new_contacts;
    contacts += bench.told({kWall_m - 0.0003, 0, 0}, {}).new_contacts;
  }
  EXPECT_EQ(contacts, 1U);
  EXPECT_EQ(bench.sut.counters().redetections, 19U);
  for (int i = 0; i < 60; ++i) bench.told({kWall_m - 0.0003, 0, 0}, {});
  EXPECT_EQ(bench.told({kWall_m + 0.0003, 0, 0}, {plane}).new_contacts, 1U);
}

}  // namespace
}  // namespace thimble::coupling
