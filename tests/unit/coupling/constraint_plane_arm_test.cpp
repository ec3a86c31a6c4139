#include "daemon/coupling/constraint_plane_arm.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "arm_bench.hpp"
#include "tests/support/random_planes.hpp"

namespace thimble::coupling {
namespace {

using test::RandomPlanes;
using testing::kPlusX;
using testing::kPlusY;
using testing::wall;
using world::PastPlanes;
using world::project;
using PlaneBench = testing::BenchOf<ConstraintPlaneArm, ConstraintPlaneSettings>;

constexpr double kRest_m = 0.0005;
const double kHalf = std::sqrt(0.5);

ConstraintPlaneSettings recovering() {
  ConstraintPlaneSettings settings;
  settings.late_walls = LateWalls::Recovery;
  return settings;
}

// Teaches the planes while the hand is outside.
void teach(PlaneBench& bench, const std::vector<ConstraintPlane>& planes) {
  bench.told({-0.01, -0.01, -0.01}, planes);
}

TEST(ConstraintPlane, OneWallPushesAlongItsNormalOnly) {
  PlaneBench bench;
  const ConstraintPlane slope = wall({kHalf, kHalf, 0}, 0.01);
  teach(bench, {slope});
  const Position3 tip{0.01, 0.008, 0.005};
  const double depth_m = kHalf * 0.018 - 0.01;
  const ArmOutput out = bench.alone(tip);
  EXPECT_TRUE(out.is_in_contact);
  EXPECT_EQ(out.new_contacts, 1U);
  EXPECT_NEAR(out.force.x, -800 * depth_m * kHalf, 1e-9);
  EXPECT_NEAR(out.force.y, -800 * depth_m * kHalf, 1e-9);
  EXPECT_EQ(out.force.z, 0);
  EXPECT_EQ(out.offset, Displacement3{});
}

// Walls that meet at 45°: beside the edge the second is touched by no hand, and holds none.
TEST(ConstraintPlane, AnEdgeHoldsTheProxyOnBothWalls) {
  const ConstraintPlane slope = wall({kHalf, kHalf, 0}, 0);
  PlaneBench sut;
  sut.told({0, -0.01, 0}, {wall(kPlusX, 0), slope});
  // Past x = 0 by 2 mm; the proxy of that wall alone would be past the slope.
  const ArmOutput edge = sut.alone({0.002, 0.001, 0});
  EXPECT_NEAR(edge.force.x, -800 * 0.002, 1e-9);
  EXPECT_NEAR(edge.force.y, -800 * 0.001, 1e-9);
  EXPECT_EQ(edge.new_contacts, 2U);
  // Further along the slope only the slope holds it.
  const ArmOutput flat = sut.alone({-0.004, 0.006, 0});
  EXPECT_NEAR(flat.force.x, -800 * 0.001, 1e-9);
  EXPECT_NEAR(flat.force.y, -800 * 0.001, 1e-9);
}

TEST(ConstraintPlane, SurfaceOfEachPlaneIsFeltWithinItsCeilings) {
  ConstraintPlane soft = wall(kPlusX, 0);
  soft.surface = {.stiffness = {200}, .damping = {0}};
  ConstraintPlane hard = wall(kPlusY, 0);
  hard.surface.stiffness = {std::numeric_limits<double>::infinity()};
  PlaneBench bench;
  teach(bench, {soft, hard});
  EXPECT_NEAR(bench.alone({0.001, -0.01, 0}, {0.1, 0, 0}).force.x, -0.2, 1e-9);
  bench.alone({-0.01, -0.01, 0});
  EXPECT_NEAR(bench.alone({-0.01, 0.001, 0}).force.y, -3.0, 1e-9);
  // Into the corner from the soft side: in between, and never more than the hard one alone.
  bench.alone({-0.01, -0.01, 0});
  bench.alone({0.001, -0.01, 0});
  const Force3 corner = bench.alone({0.001, 0.001, 0}).force;
  EXPECT_LT(norm(corner), 3000 * 0.001 * std::sqrt(2.0));
  EXPECT_GT(norm(corner), 0.2);
}

TEST(ConstraintPlane, FrictionHoldsAlongWhatThePlanesLeaveFree) {
  ConstraintPlane floor = wall(kPlusX, 0);
  ConstraintPlane side = wall(kPlusY, 0);
  floor.surface.friction = side.surface.friction = 0.5;
  PlaneBench bench;
  teach(bench, {floor, side});
  bench.alone({0.002, -0.01, 0});
  Force3 force = bench.alone({0.002, -0.005, 0.01}).force;
  EXPECT_NEAR(norm(0, force.y, force.z), 0.5 * 800 * 0.002, 1e-9) << "one wall: both ways along it";
  EXPECT_LT(force.y, 0);
  EXPECT_LT(force.z, 0);
  bench.alone({0.002, 0.001, 0.01});
  force = bench.alone({0.002, 0.001, 0.02}).force;
  EXPECT_NEAR(force.x, -1.6, 1e-9) << "an edge: along it only";
  EXPECT_NEAR(force.y, -0.8, 1e-9);
  EXPECT_NEAR(force.z, -0.5 * 800 * std::sqrt(5e-6), 1e-9);
}

TEST(ConstraintPlane, DampingNeverPulls) {
  PlaneBench bench;
  teach(bench, {wall(kPlusX, 0), wall({kHalf, kHalf, 0}, 0.001)});
  bench.alone({0.001, 0, 0});
  const ArmOutput leaving = bench.alone({0.001, 0, 0}, {-1, 0, 0});
  EXPECT_EQ(leaving.force, Force3{});
  const ArmOutput pressing = bench.alone({0.001, 0, 0}, {0.1, 0, 0});
  EXPECT_NEAR(pressing.force.x, -(0.8 + 0.5), 1e-9);
}

// teleop.md 2(f): least norm. Told of at once, from outside all of them.
TEST(ConstraintPlane, LateWallsShiftTheFrameByTheLeastThatHelps) {
  RandomPlanes random(11);
  int shifted = 0;
  for (std::size_t i = 0; i < 3000; ++i) {
    const PastPlanes told = random.around_a_free_place(1 + i % 3);
    PastPlanes too_deep;
    PlaneBench bench;
    std::vector<ConstraintPlane> planes;
    for (const auto& [normal, past_m] : told) {
      planes.push_back(wall(normal, -past_m));
      too_deep.push_back({normal, past_m - (past_m > kRest_m ? kRest_m : std::max(0.0, past_m))});
    }
    const ArmOutput out = bench.told({}, planes);
    const Displacement3 least = project(too_deep).past;
    PastPlanes left;
    for (const auto& [normal, past_m] : told)
      left.push_back({normal, past_m + dot(normal, out.offset)});
    for (const auto& [normal, past_m] : left) ASSERT_LE(past_m, kRest_m + 1e-8) << i;
    ASSERT_LE(norm(project(left).past), kRest_m * std::sqrt(3) + 1e-8) << "no kick " << i;
    // Sharp edges ask for more than the depth in each plane does.
    const Displacement3 more = -out.offset - least;
    PastPlanes after_least;
    for (const auto& [normal, past_m] : told)
      after_least.push_back({normal, past_m - dot(normal, least)});
    const double sharp_m = norm(project(after_least).past);
    if (sharp_m <= kRest_m) {
      ASSERT_NEAR(norm(more), 0, 1e-8) << i;
    }
    if (norm(out.offset) > 0) ++shifted;
  }
  EXPECT_GT(shifted, 1000);
}

TEST(ConstraintPlane, ARecoveringWallKeepsThePenetrationThenSlidesToItsPlace) {
  PlaneBench bench(recovering());
  const Position3 tip{0.010, 0, 0};
  ArmOutput out = bench.told(tip, {wall(kPlusX, 0)});
  EXPECT_NEAR(-out.force.x, 800 * kRest_m, 0.2) << "no kick";
  EXPECT_EQ(out.offset, Displacement3{});
  double last_newton = -out.force.x;
  for (int i = 0; i < 99; ++i) {
    out = bench.told(tip, {wall(kPlusX, 0)});
    EXPECT_GT(-out.force.x, last_newton);
    EXPECT_LT(-out.force.x, last_newton + 800 * 0.010 / 100 + 1e-9);
    last_newton = -out.force.x;
  }
  EXPECT_NEAR(bench.told(tip, {wall(kPlusX, 0)}).force.x, -8, 1e-9);
  EXPECT_EQ(bench.sut.recovery(), Displacement3{});
}

TEST(ConstraintPlane, ARecoveringWallWaitsWhileTheWorldIsSilent) {
  PlaneBench bench(recovering());
  bench.told({0.010, 0, 0}, {wall(kPlusX, 0)});
  for (int i = 0; i < 25; ++i) bench.alone({0.010, 0, 0});
  const Force3 frozen = bench.alone({0.010, 0, 0}).force;
  EXPECT_EQ(bench.alone({0.010, 0, 0}).force, frozen);
}

// As the ghost point: else a world that repeats it holds the arm at its peak.
TEST(ConstraintPlane, AWallBeyondTheBoundOfTheFrameIsFeltAsOneJustTouched) {
  for (const ConstraintPlaneSettings& settings : {ConstraintPlaneSettings{}, recovering()}) {
    PlaneBench bench(settings);
    for (int i = 0; i < 90; ++i) {
      const ArmOutput out = bench.told({}, {wall(kPlusX, -1e4), wall(kPlusY, -1e4)});
      const double walked_m = settings.late_walls == LateWalls::Recovery ? 0.25 : 0;
      ASSERT_LE(norm(out.force), 800 * (std::sqrt(2.0) * kRest_m + walked_m) + 1e-6);
    }
  }
  PlaneBench bench;
  bench.told({}, {wall(kPlusX, -1)});
  bench.told({}, {wall(kPlusX, 0.1)});
  for (int i = 0; i < 40'000; ++i) bench.told({}, {wall(kPlusX, 0.1)});
  EXPECT_EQ(bench.sut.recovery(), Displacement3{}) << "what the walls yielded they take back";
  EXPECT_LT(norm(bench.alone({}).offset), 1e-9);
}

TEST(ConstraintPlane, UnsoundPlanesAreIgnoredAndCounted) {
  PlaneBench bench;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const ArmOutput out =
      bench.told({0.001, 0, 0}, {wall({kNan, 0, 0}, 0), wall({2, 0, 0}, 0), wall(kPlusX, kNan)});
  EXPECT_EQ(out.force, Force3{});
  EXPECT_EQ(bench.sut.counters().rejected_planes, 3U);
}

TEST(ConstraintPlane, ATipThatIsNotFiniteLeavesTheStateAndGivesNoFiniteForce) {
  PlaneBench bench;
  bench.told({0.01, 0, 0}, {wall(kPlusX, 0)});
  const ArmOutput before = bench.alone({0.01, 0, 0});
  const ArmOutput bad = bench.alone({std::nan(""), 0, 0});
  EXPECT_FALSE(is_finite(bad.force));
  EXPECT_EQ(bad.sample.hand, before.sample.hand);
  EXPECT_EQ(bench.alone({0.01, 0, 0}).force, before.force);
}

TEST(ConstraintPlane, WallFadesInSilenceThenIsForgotten) {
  PlaneBench bench;
  teach(bench, {wall({kHalf, kHalf, 0}, 0)});
  double last_newton = norm(bench.alone({0.002, 0.002, 0}).force);
  EXPECT_GT(last_newton, 2);
  ArmOutput out{};
  for (int i = 0; i < 360; ++i) {
    out = bench.alone({0.002, 0.002, 0});
    ASSERT_LE(norm(out.force), last_newton + 1e-12);
    ASSERT_GT(norm(out.force), last_newton - 0.03);
    last_newton = norm(out.force);
  }
  EXPECT_EQ(out.force, Force3{});
  EXPECT_TRUE(out.is_fading);
  EXPECT_FALSE(out.is_in_contact);
}

TEST(ConstraintPlane, ResetStartsAgainAtTheHand) {
  PlaneBench bench;
  bench.told({0.01, 0, 0}, {wall(kPlusX, 0)});
  bench.sut.reset(bench.now, {0.01, 0, 0});
  const ArmOutput out = bench.alone({0.01, 0, 0});
  EXPECT_EQ(out.force, Force3{});
  EXPECT_EQ(out.offset, Displacement3{});
  EXPECT_EQ(out.sample.restart, 2U);
}

}  // namespace
}  // namespace thimble::coupling
