#include "daemon/world/shapes/shape.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "random_shapes.hpp"

namespace thimble::world {
namespace {

using testing::RandomShapes;

constexpr std::array kKinds{ShapeKind::Sphere, ShapeKind::Box, ShapeKind::Capsule,
                            ShapeKind::Cylinder, ShapeKind::Floor};

// Where a step of the distance against the outward way must lie: on the surface.
TEST(Shape, TheDistanceLeadsToTheSurface) {
  RandomShapes random(1);
  for (int i = 0; i < 50'000; ++i) {
    const PlacedShape sut(random.shape(kKinds[static_cast<std::size_t>(i) % kKinds.size()]));
    const Position3 at = random.place(0.1);
    const Outside seen = sut.look(at);
    ASSERT_NEAR(norm(seen.outward), 1, 1e-12);
    const Position3 foot = at - along<DisplacementTag>(seen.outward, seen.distance_m);
    ASSERT_NEAR(sut.look(foot).distance_m, 0, 1e-12) << i;
  }
}

// No place of the other side is nearer: a signed distance changes by no more than the way between
// two places, and its sign tells sides.
TEST(Shape, NoPlaceOfTheOtherSideIsNearerThanTheDistance) {
  RandomShapes random(2);
  int crossings = 0;
  for (int i = 0; i < 300; ++i) {
    const PlacedShape sut(random.shape(kKinds[static_cast<std::size_t>(i) % kKinds.size()]));
    const Position3 at = random.place(0.06);
    const double distance_m = sut.look(at).distance_m;
    for (int k = 0; k < 3000; ++k) {
      const Position3 other = random.place(0.06);
      const double other_m = sut.look(other).distance_m;
      ASSERT_LE(std::abs(other_m - distance_m), norm(other - at) + 1e-12);
      if ((other_m < 0) != (distance_m < 0)) ++crossings;
    }
  }
  EXPECT_GT(crossings, 10'000);
}

// The promise of shape.hpp, on which the motion relies.
TEST(Shape, DistanceIsConvexAlongEveryWay) {
  RandomShapes random(3);
  for (int i = 0; i < 50'000; ++i) {
    const PlacedShape sut(random.shape(kKinds[static_cast<std::size_t>(i) % kKinds.size()]));
    const Position3 from = random.place(0.06);
    const Displacement3 way = random.place(0.06) - from;
    const Outside start = sut.look(from);
    const double share = random.uniform(0, 1);
    const double least_m = start.distance_m + share * dot(start.outward, way);
    ASSERT_GE(sut.look(from + share * way).distance_m, least_m - 1e-12) << i;
  }
}

TEST(Shape, SidesAreWhereTheyAreSaidToBe) {
  Shape box{.kind = ShapeKind::Box, .center = {0.01, 0, 0}, .half_m = {0.01, 0.02, 0.03}};
  EXPECT_NEAR(PlacedShape(box).look({0.05, 0, 0}).distance_m, 0.03, 1e-15);
  EXPECT_NEAR(PlacedShape(box).look({0.01, 0, 0}).distance_m, -0.01, 1e-15);
  box.turn_rad = {0, 0, 1.5707963267948966};  // its y lies along -x
  EXPECT_NEAR(PlacedShape(box).look({0.05, 0, 0}).distance_m, 0.02, 1e-12);
  const Shape rod{.kind = ShapeKind::Capsule, .radius_m = 0.005, .half_m = {0, 0.02, 0}};
  EXPECT_NEAR(PlacedShape(rod).look({0, 0.03, 0}).distance_m, 0.005, 1e-15);
  EXPECT_NEAR(PlacedShape(rod).look({0.01, 0.01, 0}).distance_m, 0.005, 1e-15);
  const Shape can{.kind = ShapeKind::Cylinder, .radius_m = 0.01, .half_m = {0, 0.02, 0}};
  EXPECT_NEAR(PlacedShape(can).look({0.013, 0.024, 0}).distance_m, 0.005, 1e-15);
  const Shape floor{.kind = ShapeKind::Floor, .center = {0, -0.04, 0}};
  EXPECT_NEAR(PlacedShape(floor).look({5, 0, 7}).distance_m, 0.04, 1e-15);
  EXPECT_EQ(PlacedShape(floor).look({5, 0, 7}).outward, (Direction3{0, 1, 0}));
}

TEST(Shape, MirroredAndPermutedPlacesHaveMirroredAndPermutedNormals) {
  const PlacedShape sut({.kind = ShapeKind::Box, .half_m = {0.01, 0.01, 0.01}});
  RandomShapes random(4);
  for (int i = 0; i < 10'000; ++i) {
    const Position3 at = random.place(0.03);
    const Outside seen = sut.look(at);
    const Outside mirrored = sut.look({-at.x, at.y, -at.z});
    EXPECT_EQ(mirrored.distance_m, seen.distance_m);
    EXPECT_EQ(mirrored.outward, (Direction3{-seen.outward.x, seen.outward.y, -seen.outward.z}));
    const Outside turned = sut.look({at.y, at.z, at.x});
    EXPECT_NEAR(turned.distance_m, seen.distance_m, 1e-15);
    EXPECT_NEAR(turned.outward.x, seen.outward.y, 1e-12);
  }
}

TEST(Shape, WhatIsNotFiniteOrTooSmallIsNotSound) {
  RandomShapes random(5);
  for (const ShapeKind kind : kKinds) {
    const Shape good = random.shape(kind);
    EXPECT_TRUE(PlacedShape::is_sound(good));
    for (const double bad : {std::numeric_limits<double>::infinity(), std::nan("")}) {
      Shape shape = good;
      shape.center.y = bad;
      EXPECT_FALSE(PlacedShape::is_sound(shape));
      shape = good;
      shape.turn_rad.z = bad;
      EXPECT_FALSE(PlacedShape::is_sound(shape));
    }
    Shape flat = good;
    flat.radius_m = 0;
    flat.half_m = {};
    EXPECT_EQ(PlacedShape::is_sound(flat), kind == ShapeKind::Floor);
  }
}

}  // namespace
}  // namespace thimble::world
