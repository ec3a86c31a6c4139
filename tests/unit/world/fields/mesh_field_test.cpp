#include "daemon/world/fields/mesh_field.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "daemon/world/fields/field_motion.hpp"
#include "daemon/world/shapes/shape.hpp"
#include "solid_meshes.hpp"
#include "tests/support/random_planes.hpp"

namespace thimble::world {
namespace {

using test::RandomPlanes;
using namespace testing;  // NOLINT(google-build-using-namespace)

constexpr double kRoot3 = 1.7320508075688772;

// The largest error at random places as far from its middle.
double worst_m(const DistanceField& field, const PlacedShape& exact, double least_m,
               double most_m) {
  RandomPlanes random(21);
  double worst = 0;
  for (int i = 0; i < 20000; ++i) {
    const Position3 at =
        Position3{} + along<DisplacementTag>(random.direction(), random.uniform(least_m, most_m));
    worst = std::max(worst, std::abs(field.look(at).distance_m - exact.look(at).distance_m));
  }
  return worst;
}

TEST(MeshField, OfABallIsAsNearAsItsTriangles) {
  const PlacedShape ball({.kind = ShapeKind::Sphere, .radius_m = 0.03});
  for (const int cuts : {3, 4}) {
    const Mesh mesh = ball_mesh(cuts, 30);
    double below_m = 0;  // the middle of a triangle is below the ball
    for (const auto& [a, b, c] : mesh.triangles) {
      const Displacement3 out = mesh.corners[a] - Position3{} + (mesh.corners[b] - Position3{}) +
                                (mesh.corners[c] - Position3{});
      below_m = std::max(below_m, 0.03 - 0.001 * norm(out) / 3);
    }
    const auto sut = make_field(mesh, {.resolution = 48, .unit_m = 0.001});
    ASSERT_TRUE(sut) << sut.error().message;
    // Between nodes, what a ball bends within a step.
    const double bend_m = 3 * sut->step_m() * sut->step_m() / 0.03;
    EXPECT_LE(worst_m(*sut, ball, 0.028, 0.032), below_m + bend_m) << cuts;
    EXPECT_LE(worst_m(*sut, ball, 0.015, 0.028), 0.001)
        << "deep inside nearly the nearest is enough";
  }
}

TEST(MeshField, OfABoxIsExactButNearItsEdges) {
  const PlacedShape box({.kind = ShapeKind::Box, .half_m = {0.03, 0.02, 0.01}});
  const Mesh mesh = moved(box_mesh({0, 0, 0}, {60, 40, 20}), {100, 200, -300});
  const auto sut = make_field(mesh, {.resolution = 60});
  ASSERT_TRUE(sut) << sut.error().message;
  EXPECT_DOUBLE_EQ(sut->step_m(), 0.001) << "its longest edge is made 60 mm";
  EXPECT_EQ(sut->numbers(), (std::array<std::uint32_t, 3>{65, 45, 25}));
  EXPECT_LE(worst_m(*sut, box, 0, 0.03), sut->step_m() * kRoot3 / 2);
  RandomPlanes random(22);
  for (int i = 0; i < 2000; ++i) {  // over a face, two steps from its rim
    const Position3 at = Position3{0, 0, 0.01} + random.displacement(0.0019);
    ASSERT_NEAR(sut->look(at).distance_m, box.look(at).distance_m, 1e-8);
  }
}

TEST(MeshField, LiesWhereItIsPutAndAsLargeAsItIsSaid) {
  const auto sut = make_field(box_mesh({0, 0, 0}, {2, 1, 1}),
                              {.resolution = 16, .unit_m = 0.01, .center = {0, 0.1, 0}});
  ASSERT_TRUE(sut);
  EXPECT_NEAR(sut->look({0, 0.1, 0}).distance_m, -0.005, 1e-6);
  EXPECT_NEAR(sut->look({0, 0.108, 0}).distance_m, 0.003, 1e-6);
}

TEST(MeshField, PartsThatOverlapAreOneAndHollowsAreFree) {
  const auto sut = make_field(both(both(ball_mesh(3, 20), moved(ball_mesh(3, 20), {25, 0, 0})),
                                   inside_out(moved(ball_mesh(2, 8), {-5, 0, 0}))),
                              {.resolution = 40, .unit_m = 0.001});
  ASSERT_TRUE(sut) << sut.error().message;
  const Displacement3 middle{-0.0125, 0, 0};  // of the box around both
  EXPECT_LT(sut->look(Position3{0.010, 0, 0} + middle).distance_m, 0) << "in both";
  EXPECT_LT(sut->look(Position3{-0.016, 0, 0} + middle).distance_m, 0) << "between ball and hollow";
  EXPECT_GT(sut->look(Position3{-0.005, 0, 0} + middle).distance_m, 0.006) << "in the hollow";
  EXPECT_GT(sut->look(Position3{0.048, 0, 0} + middle).distance_m, 0) << "beside";
}

TEST(MeshField, WhatIsWrongIsSaidWithItsPlace) {
  const auto said = [](const Mesh& mesh, const MeshFieldOptions& options) {
    const auto sut = make_field(mesh, options);
    return sut ? "" : sut.error().message;
  };
  const std::string hidden =
      said(both(ball_mesh(3, 20), moved(inside_out(ball_mesh(2, 5)), {100, 0, 0})),
           {.resolution = 64, .unit_m = 0.001});
  EXPECT_TRUE(hidden.starts_with("mesh: the part of it around (") &&
              hidden.ends_with("is inside out"))
      << hidden;
  EXPECT_EQ(said(ball_mesh(1, 1e-3), {.unit_m = 0.001}),
            "mesh: its longest edge would be 0.000002 m, not 1e-4 to 10 m: say what its unit is");
  EXPECT_FALSE(make_field(ball_mesh(1, 1), {.resolution = 7}));
  EXPECT_FALSE(make_field(ball_mesh(1, 1), {.resolution = 257}));
  EXPECT_FALSE(make_field({}, {}));
}

TEST(MeshField, HoldsAHandThatJumpsOutsideItsTriangles) {
  RandomPlanes random(23);
  const Mesh star = star_mesh(3, [&](Displacement3) { return 20 + 5 * random.uniform(0, 1); });
  const auto sut = make_field(star, {.resolution = 64, .unit_m = 0.001});
  ASSERT_TRUE(sut);
  const auto& [low, high] = box_around(star);
  const Displacement3 middle = (low + 0.5 * (high - low)) - Position3{};
  Position3 ghost{0, 0.05, 0};
  for (int i = 0; i < 3000; ++i) {
    const Position3 at = move_ghost(*sut, {}, ghost, Position3{} + random.displacement(0.05)).ghost;
    const Position3 in_mesh = Position3{} + 1000.0 * (at - Position3{}) + middle;
    const Position3 further =
        in_mesh + (1000 * sut->step_m() * kRoot3 / 2 / norm(at - Position3{})) * (at - Position3{});
    ASSERT_NEAR(winding_of(star, further), 0, 0.01) << i << ": deeper than a field may err";
  }
}

// The same mesh mirrored is the same field mirrored.
TEST(MeshField, OfAMirroredMeshIsMirrored) {
  RandomPlanes random(24);
  const Mesh star = star_mesh(2, [&](Displacement3) { return 20 + 5 * random.uniform(0, 1); });
  Mesh mirrored = inside_out(star);
  for (Position3& corner : mirrored.corners) corner.y = -corner.y;
  const auto sut = make_field(star, {.resolution = 40, .unit_m = 0.001});
  const auto other = make_field(mirrored, {.resolution = 40, .unit_m = 0.001});
  ASSERT_TRUE(sut && other);
  for (int i = 0; i < 5000; ++i) {
    const Position3 at = Position3{} + random.displacement(0.03);
    const double here_m = sut->look(at).distance_m;
    const bool is_near = std::abs(here_m) < 2 * sut->step_m();
    ASSERT_NEAR(here_m, other->look({at.x, -at.y, at.z}).distance_m, is_near ? 1e-8 : 1e-3);
  }
}

}  // namespace
}  // namespace thimble::world
