#include "daemon/world/fields/distance_field.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "analytic_field.hpp"
#include "daemon/world/shapes/shape.hpp"
#include "tests/support/random_planes.hpp"

namespace thimble::world {
namespace {

using test::RandomPlanes;
using testing::sampled;

constexpr double kBallStep_m = 0.002;
constexpr double kBallRadius_m = 0.02;
double ball_m(Position3 at) { return norm(at - Position3{}) - kBallRadius_m; }

// Between nodes a field of curvature 1/r is wrong by at most three times step²/(8·r), outside the
// cells about its middle, where a ball's distance has a point.
TEST(DistanceField, FollowsABallWithinItsStepSquared) {
  const DistanceField sut = sampled(40, kBallStep_m, ball_m);
  RandomPlanes random(1);
  for (int i = 0; i < 50'000; ++i) {
    const Position3 at = Position3{} + random.displacement(0.037);
    const double from_middle_m = norm(at - Position3{});
    if (from_middle_m < 0.010) continue;
    const FieldLook seen = sut.look(at);
    ASSERT_NEAR(seen.distance_m, ball_m(at), 3 * kBallStep_m * kBallStep_m / (8 * 0.006)) << i;
    const Direction3 out{at.x / from_middle_m, at.y / from_middle_m, at.z / from_middle_m};
    ASSERT_GT(dot(seen.outward, out), 0.95);
    ASSERT_NEAR(seen.slope, 1, 0.1);
  }
}

// A plane is trilinear: exact, whichever way it lies.
TEST(DistanceField, PlanesAreExact) {
  RandomPlanes random(2);
  for (int i = 0; i < 50; ++i) {
    const Direction3 up = random.direction();
    const DistanceField sut = sampled(9, 0.01, [&](Position3 at) { return dot(up, at) - 0.005; });
    for (int k = 0; k < 200; ++k) {
      const Position3 at = Position3{} + random.displacement(0.04);
      const FieldLook seen = sut.look(at);
      ASSERT_NEAR(seen.distance_m, dot(up, at) - 0.005, 1e-8);
      ASSERT_NEAR(norm(seen.outward - up), 0, 1e-6);
    }
  }
}

// The promise on which the motion relies: of any numbers, within and beyond the lattice.
TEST(DistanceField, NothingFallsFasterThanItSays) {
  RandomPlanes random(3);
  for (int i = 0; i < 30; ++i) {
    const DistanceField sut =
        sampled(6, 0.01, [&](Position3) { return random.uniform(-0.03, 0.03); });
    for (int k = 0; k < 5000; ++k) {
      const Position3 a = Position3{} + random.displacement(0.06);
      const Position3 b = a + random.displacement(0.01);
      const double change_m = std::abs(sut.look(a).distance_m - sut.look(b).distance_m);
      ASSERT_LE(change_m, sut.steepest() * norm(b - a) + 1e-12);
    }
  }
}

TEST(DistanceField, TheGradientIsTheChangeOfTheDistance) {
  RandomPlanes random(4);
  const DistanceField sut =
      sampled(6, 0.01, [&](Position3) { return random.uniform(-0.03, 0.03); });
  constexpr double kEps_m = 1e-7;
  for (int k = 0; k < 5000; ++k) {
    const Position3 at = Position3{} + random.displacement(0.024);
    bool is_at_a_node = false;  // the gradient changes from cell to cell
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double steps = at[axis] / 0.01 + 0.5;
      is_at_a_node = is_at_a_node || std::abs(steps - std::round(steps)) < 1e-4;
    }
    if (is_at_a_node) continue;
    const FieldLook seen = sut.look(at);
    const Displacement3 way = random.displacement(kEps_m);
    const double change_m = sut.look(at + way).distance_m - seen.distance_m;
    ASSERT_NEAR(change_m, seen.slope * dot(seen.outward, way), 1e-3 * kEps_m * sut.steepest());
  }
}

TEST(DistanceField, BeyondTheLatticeItGrowsWithTheWay) {
  const DistanceField sut = sampled(11, 0.01, ball_m);
  EXPECT_NEAR(sut.look({0.15, 0, 0}).distance_m, 0.03 + 0.10, 1e-6);
  EXPECT_NEAR(sut.look({1e3, 0, 0}).distance_m, 0.03 + 1e3 - 0.05, 1e-3);
  EXPECT_GT(sut.look({0.15, 0, 0}).outward.x, 0.99);
}

TEST(DistanceField, RefusesWhatIsNoField) {
  const std::vector<float> eight(8, 1);
  EXPECT_TRUE(DistanceField::create({2, 2, 2}, 0.01, eight));
  EXPECT_FALSE(DistanceField::create({2, 2, 3}, 0.01, eight));
  EXPECT_FALSE(DistanceField::create({1, 2, 4}, 0.01, eight));
  EXPECT_EQ(DistanceField::check({1024, 1024, 1024}, 0.01).error().code, Errc::TooLarge);
  for (const double step_m : {0.0, -1.0, 11.0, std::nan("")}) {
    EXPECT_FALSE(DistanceField::create({2, 2, 2}, step_m, eight)) << step_m;
  }
  for (const float bad : {std::numeric_limits<float>::infinity(), std::nanf(""), 1001.0F}) {
    std::vector<float> numbers = eight;
    numbers[5] = bad;
    EXPECT_EQ(DistanceField::create({2, 2, 2}, 0.01, numbers).error().code, Errc::Malformed);
  }
}

}  // namespace
}  // namespace thimble::world
