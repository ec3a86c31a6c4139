#include "hal/base/geometry.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <type_traits>

#include "hal/base/time.hpp"

namespace thimble {
namespace {

template <class A, class B>
concept Adds = requires(A a, B b) {
  a + b;
};

static_assert(!Adds<Position3, Position3>, "points do not add");
static_assert(!Adds<Force3, Displacement3>, "forces and displacements do not mix");
static_assert(!std::is_convertible_v<Displacement3, Force3>);
static_assert(std::is_same_v<decltype(Position3{} - Position3{}), Displacement3>);
static_assert(std::is_same_v<decltype(Stiffness{} * Displacement3{}), Force3>);

TEST(Geometry, StiffnessTimesDisplacementIsAForce) {
  EXPECT_EQ((Stiffness{800} * Displacement3{0.001, 0, -0.002}), (Force3{0.8, 0, -1.6}));
}

TEST(Geometry, FinitenessSeesEveryComponent) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(is_finite(Force3{1, 2, 3}));
  EXPECT_FALSE(is_finite(Force3{nan, 0, 0}));
  EXPECT_FALSE(is_finite(Force3{0, -infinity, 0}));
  EXPECT_FALSE(is_finite(Position3{0, 0, nan}));
}

TEST(Geometry, NormIsRightAtEverySize) {
  for (int exponent = -300; exponent <= 300; ++exponent) {
    const double unit = std::pow(10.0, exponent);
    const Force3 edges{2 * unit, -3 * unit, 6 * unit};
    EXPECT_NEAR(norm(edges) / unit, 7.0, 1e-14) << exponent;
    EXPECT_EQ(norm(Force3{0, -unit, 0}), unit) << exponent;
    EXPECT_EQ(norm(Force3{unit, 1e-150 * unit, 0}), unit) << exponent;
  }
  EXPECT_EQ(norm(Force3{}), 0);
}

TEST(Geometry, NormOfWhatIsNotFiniteIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(std::isfinite(norm(Force3{1, nan, 0})));
  EXPECT_FALSE(std::isfinite(norm(Force3{0, 1, -infinity})));
}

TEST(Time, SecondsRoundTripToTheNanosecond) {
  EXPECT_EQ(from_seconds(0.001), Duration(1'000'000));
  EXPECT_EQ(from_seconds(-0.25), Duration(-250'000'000));
  EXPECT_DOUBLE_EQ(seconds(Duration(1'500'000'000)), 1.5);
}

}  // namespace
}  // namespace thimble
