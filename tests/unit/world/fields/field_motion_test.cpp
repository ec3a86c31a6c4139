#include "daemon/world/fields/field_motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "analytic_field.hpp"
#include "daemon/world/fields/field_world.hpp"
#include "daemon/world/shapes/shape_motion.hpp"
#include "tests/support/random_planes.hpp"

namespace thimble::world {
namespace {

using test::RandomPlanes;
using testing::sampled;

constexpr double kGrid_m = 0.002;
constexpr Duration kTick = std::chrono::milliseconds(1);

// A ball beside a leaning box, and the same as shapes.
std::vector<PlacedShape> solids() {
  return {PlacedShape({.kind = ShapeKind::Sphere, .center = {-0.012, 0, 0}, .radius_m = 0.015}),
          PlacedShape({.kind = ShapeKind::Box,
                       .center = {0.015, 0.002, 0},
                       .turn_rad = {0.2, 0.1, 0.5},
                       .half_m = {0.008, 0.015, 0.01}})};
}
double solids_m(Position3 at) {
  double least_m = 1;
  for (const PlacedShape& solid : solids()) least_m = std::min(least_m, solid.look(at).distance_m);
  return least_m;
}

TEST(FieldMotion, TheGhostIsNeverInsideAndItsPlaneIsTangent) {
  const DistanceField sut = sampled(41, kGrid_m, solids_m);
  RandomPlanes random(1);
  Position3 ghost{0, 0.04, 0};
  int held = 0;
  for (int i = 0; i < 5000; ++i) {
    const ProbeMotion motion = move_ghost(sut, {}, ghost, Position3{} + random.displacement(0.05));
    ASSERT_GT(sut.look(motion.ghost).distance_m, 0) << i;
    for (const ContactPlane& plane : motion.planes) {
      ASSERT_GE(plane.offset_m - dot(plane.normal, motion.ghost), -kGrid_m / 500);
    }
    if (motion.planes.empty()) continue;
    ++held;
    const ContactPlane& plane = motion.planes[0];
    ASSERT_NEAR(plane.offset_m - dot(plane.normal, motion.ghost), 0, kGrid_m / 100);
    ASSERT_LT(
        sut.look(motion.ghost + along<DisplacementTag>(plane.normal, kGrid_m / 20)).distance_m, 0);
  }
  EXPECT_GT(held, 1000);
}

TEST(FieldMotion, APlateOfTwoStepsHoldsAHandThatJumps) {
  const DistanceField sut =
      sampled(41, kGrid_m, [](Position3 at) { return std::abs(at.y) - kGrid_m; });
  RandomPlanes random(2);
  Position3 ghost{0, 0.02, 0};
  for (int i = 0; i < 5000; ++i) {
    Position3 hand = Position3{} + random.displacement(0.5);
    hand.x = std::clamp(hand.x, -0.035, 0.035);  // within its edges
    hand.z = std::clamp(hand.z, -0.035, 0.035);
    ASSERT_GT(move_ghost(sut, {}, ghost, hand).ghost.y, 0.9 * kGrid_m) << i;
  }
}

// A dent between two walls holds by both, so that no scheme is drawn into one while the other
// turns.
TEST(FieldMotion, ACornerHoldsAHandByItsTwoWalls) {
  RandomPlanes random(5);
  for (int i = 0; i < 40; ++i) {
    const double angle = random.uniform(0.7, 2.3);
    const double turn = random.uniform(0, 6);
    const Direction3 floor{-std::sin(turn), std::cos(turn), 0};  // both point out of the matter
    const Direction3 wall{std::sin(turn + angle), -std::cos(turn + angle), 0};
    const DistanceField sut =
        sampled(31, kGrid_m, [&](Position3 at) { return std::min(dot(floor, at), dot(wall, at)); });
    const Displacement3 middle{std::cos(turn + angle / 2), std::sin(turn + angle / 2), 0};
    Position3 ghost = Position3{} + 0.015 * middle;
    const Position3 hand = Position3{} - 0.005 * middle;
    ProbeMotion motion;
    for (int tick = 0; tick < 20; ++tick) motion = move_ghost(sut, {}, ghost, hand);
    PastPlanes planes;
    for (const ContactPlane& plane : motion.planes) {
      planes.push_back({plane.normal, dot(plane.normal, hand) - plane.offset_m});
    }
    const Position3 proxy = hand - project(planes).past;
    EXPECT_GE(motion.planes.size(), 2U) << i;
    EXPECT_LE(norm(proxy - Position3{}), 1.5 * kGrid_m) << i << ", " << angle;
  }
}

// A finger stroked over it is led as over the shapes that it was made of.
TEST(FieldMotion, GoesAsOverTheShapesItWasMadeOf) {
  const DistanceField sut =
      sampled(101, kGrid_m / 2, [](Position3 at) { return solids()[0].look(at).distance_m; });
  const std::vector<PlacedShape> shapes{solids()[0]};
  Position3 in_field{-0.012, 0.02, 0};
  Position3 among_shapes = in_field;
  for (int i = 0; i < 4000; ++i) {
    const double angle = 0.5 + 0.001 * i;
    const Position3 hand{-0.012 + 0.012 * std::cos(angle), 0.012 * std::sin(angle),
                         0.005 * std::sin(3 * angle)};
    if (i == 0) move_ghost(sut, {}, in_field, hand);  // a jump that takes it more than one move
    const Position3 a = move_ghost(sut, {}, in_field, hand).ghost;
    const Position3 b = move_ghost(shapes, among_shapes, hand).ghost;
    ASSERT_LE(norm(a - b), 2e-4) << i;
  }
}

TEST(FieldMotion, RestsWhereNoWayLeadsNearer) {
  const DistanceField sut = sampled(41, kGrid_m, solids_m);
  RandomPlanes random(3);
  for (int world = 0; world < 200; ++world) {
    Position3 ghost = Position3{} + along<DisplacementTag>(random.direction(), 0.045);
    const Position3 hand = Position3{-0.012, 0, 0} + random.displacement(0.010);
    ProbeMotion motion;
    for (int i = 0; i < 20; ++i) motion = move_ghost(sut, {}, ghost, hand);
    const double left_m = norm(hand - ghost);
    ASSERT_EQ(motion.planes.empty(), left_m < 1e-6) << world << ": it rests, so something holds it";
    for (int k = 0; k < 300; ++k) {
      const Position3 near = ghost + random.displacement(1e-4);
      if (sut.look(near).distance_m < kGrid_m / 1000) continue;
      ASSERT_GE(norm(hand - near), left_m - 2e-5) << world;
    }
  }
}

TEST(FieldMotion, MirroredFieldsMoveMirroredGhosts) {
  const auto run = [](double sign) {
    const DistanceField sut = sampled(41, kGrid_m, [sign](Position3 at) {
      return solids_m({sign * at.x, at.y, at.z});
    });
    RandomPlanes random(4);
    Position3 ghost{0, 0.04, 0};
    std::vector<Position3> trace;
    for (int i = 0; i < 1000; ++i) {
      const Position3 hand = Position3{} + random.displacement(0.04);
      const Position3 at = move_ghost(sut, {}, ghost, {sign * hand.x, hand.y, hand.z}).ghost;
      trace.push_back({sign * at.x, at.y, at.z});
      ghost = {sign * trace.back().x, at.y, at.z};
    }
    return trace;
  };
  const auto reference = run(1);
  const auto mirrored = run(-1);
  std::size_t alike = 0;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    if (norm(mirrored[i] - reference[i]) < 1e-6) ++alike;
  }
  // Rounding decides on which side of a crease a few of them go.
  EXPECT_GE(alike, reference.size() * 95 / 100);
}

TEST(FieldWorld, StartsOutsideFeelsItsSurfaceAndSaysWhenThereIsNoRoom) {
  FieldWorld world(sampled(41, kGrid_m, solids_m), "solids", {{300}, {2}, 0.1});
  EXPECT_NEAR(world.info().extent_m[0], 0.08, 1e-12);
  EXPECT_EQ(world.info().cells[0], 0U);
  const auto probe = world.add_probe({-0.012, 0, 0});
  ASSERT_TRUE(probe);
  const ProbeMotion motion = world.move_probe(*probe, {-0.012, 0.001, 0}, kTick);
  EXPECT_GT(world.field().look(motion.ghost).distance_m, 0);
  ASSERT_EQ(motion.planes.size(), 1U);
  EXPECT_EQ(motion.planes[0].stiffness, Stiffness{300});
  EXPECT_FALSE(world.add_probe({std::nan(""), 0, 0}));
  const Position3 before = motion.ghost;
  EXPECT_EQ(world.move_probe(*probe, {0, std::nan(""), 0}, kTick).ghost, before);
  world.remove_probe(*probe);
  EXPECT_EQ(world.move_probe(*probe, {9, 9, 9}, kTick).ghost, (Position3{9, 9, 9}));

  FieldWorld full(sampled(3, 1, [](Position3) { return -900.0; }), "full");
  EXPECT_EQ(full.add_probe({}).error().code, Errc::NotFound);
}

}  // namespace
}  // namespace thimble::world
