#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "analytic_field.hpp"
#include "daemon/world/fields/field_motion.hpp"
#include "daemon/world/plane_projection.hpp"
#include "daemon/world/shapes/shape_motion.hpp"
#include "tests/support/random_planes.hpp"

// What worlds of shapes and of fields tell makes a god-object (teleop.md 2(f)).
namespace thimble::world {
namespace {

using test::RandomPlanes;

constexpr double kLattice_m = 0.002;

// Boxes and balls that overlap any way, about the origin.
std::vector<Shape> random_solids(RandomPlanes& random) {
  std::vector<Shape> out;
  for (int i = 0; i < 3; ++i) {
    Shape shape{.kind = i == 0 ? ShapeKind::Sphere : ShapeKind::Box, .radius_m = 0.01};
    shape.center = Position3{} + random.displacement(0.012);
    shape.turn_rad = random.displacement(3);
    shape.half_m = {0.008, 0.012, 0.016};
    out.push_back(shape);
  }
  return out;
}
std::vector<PlacedShape> placed(const std::vector<Shape>& shapes) {
  return {shapes.begin(), shapes.end()};
}
DistanceField field_of(const std::vector<PlacedShape>& shapes) {
  return testing::sampled(31, kLattice_m, [&](Position3 at) {
    double least_m = 1;
    for (const PlacedShape& shape : shapes) {
      least_m = std::min(least_m, shape.look(at).distance_m);
    }
    return least_m;
  });
}

using Move = std::function<ProbeMotion(Position3& ghost, Position3 hand)>;

// The conditions, for hands that stroke over the solids and jump now and then; `touch_m` is how far
// from its planes a ghost may be.
int count_held(RandomPlanes& random, double touch_m, const Move& move) {
  Position3 ghost{0, 0.05, 0};
  Position3 hand = ghost;
  int held = 0;
  for (int i = 0; i < 400; ++i) {
    hand =
        i % 20 == 0 ? Position3{} + random.displacement(0.03) : hand + random.displacement(0.002);
    const ProbeMotion motion = move(ghost, hand);
    PastPlanes planes;
    for (const ContactPlane& plane : motion.planes) {
      EXPECT_LE(dot(plane.normal, motion.ghost), plane.offset_m + touch_m) << "the ghost is free";
      planes.push_back({plane.normal, dot(plane.normal, hand) - plane.offset_m});
    }
    const PlaneProjection sut = project(planes);
    EXPECT_TRUE(sut.has_place);
    Displacement3 sum{};
    for (std::size_t k = 0; k < planes.size(); ++k) {
      const double past_m = planes[k].past_m - dot(planes[k].normal, sut.past);
      EXPECT_LE(past_m, 1e-7) << "admissible";
      EXPECT_GE(sut.share[k], 0) << "no plane pulls";
      EXPECT_TRUE(sut.share[k] == 0 || std::abs(past_m) <= 1e-7) << "complementary";
      sum = sum + along<DisplacementTag>(planes[k].normal, sut.share[k]);
    }
    EXPECT_LE(norm(sum - sut.past), 1e-9);
    held += motion.planes.empty() ? 0 : 1;
  }
  return held;
}

TEST(GodObject, OfShapesIsAdmissibleAndComplementary) {
  RandomPlanes random(31);
  int held = 0;
  for (int world = 0; world < 20; ++world) {
    const auto shapes = placed(random_solids(random));
    held += count_held(random, 1e-6, [&](Position3& ghost, Position3 hand) {
      return move_ghost(shapes, ghost, hand);
    });
  }
  EXPECT_GT(held, 2000);
}

TEST(GodObject, OfFieldsIsAdmissibleAndComplementary) {
  RandomPlanes random(32);
  int held = 0;
  for (int world = 0; world < 20; ++world) {
    const DistanceField field = field_of(placed(random_solids(random)));
    held += count_held(random, kLattice_m / 500, [&](Position3& ghost, Position3 hand) {
      return move_ghost(field, {}, ghost, hand);
    });
  }
  EXPECT_GT(held, 2000);
}

// x becomes y, y becomes z, z becomes x.
Position3 turned(Position3 at) { return {at.z, at.x, at.y}; }

// Where a solid is turned along the axes, so is what it does: but for roundings, which decide at a
// crease on which side of it a ghost goes.
TEST(GodObject, OfPermutedFieldsIsPermuted) {
  RandomPlanes random(33);
  int alike = 0;
  int all = 0;
  for (int world = 0; world < 5; ++world) {
    const auto shapes = placed(random_solids(random));
    const DistanceField field = field_of(shapes);
    const DistanceField permuted = testing::sampled(31, kLattice_m, [&](Position3 at) {
      double least_m = 1;
      for (const PlacedShape& shape : shapes) {
        least_m = std::min(least_m, shape.look({at.y, at.z, at.x}).distance_m);
      }
      return least_m;
    });
    Position3 ghost{0, 0.05, 0};
    for (int i = 0; i < 400; ++i, ++all) {
      const Position3 hand = Position3{} + random.displacement(0.03);
      Position3 other = turned(ghost);
      const ProbeMotion sut = move_ghost(permuted, {}, other, turned(hand));
      const ProbeMotion reference = move_ghost(field, {}, ghost, hand);
      const bool is_alike = norm(sut.ghost - turned(reference.ghost)) < 1e-6 &&
                            sut.planes.size() == reference.planes.size();
      alike += is_alike ? 1 : 0;
    }
  }
  EXPECT_GE(alike, all * 95 / 100);
}

}  // namespace
}  // namespace thimble::world
