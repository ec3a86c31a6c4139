#include "daemon/world/shapes/shape_motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "daemon/world/shapes/shape_world.hpp"
#include "random_shapes.hpp"

namespace thimble::world {
namespace {

using testing::distance_m;
using testing::placed;
using testing::RandomShapes;

constexpr Duration kStep = std::chrono::milliseconds(1);

// A free place to begin with.
Position3 free_place(RandomShapes& random, const std::vector<PlacedShape>& shapes) {
  for (;;) {
    const Position3 at = random.place(0.08);
    if (distance_m(shapes, at) > 0.001) return at;
  }
}

// Every straight way between two places, looked at in steps of a twentieth of a millimetre.
double least_between_m(const std::vector<PlacedShape>& shapes, Position3 from, Position3 to) {
  const auto steps = static_cast<int>(norm(to - from) / 5e-5) + 1;
  double least_m = 1;
  for (int i = 0; i <= steps; ++i) {
    least_m = std::min(least_m, distance_m(shapes, from + (1.0 * i / steps) * (to - from)));
  }
  return least_m;
}

TEST(ShapeMotion, AHandInFreeSpaceIsReached) {
  RandomShapes random(1);
  int reached = 0;
  for (int i = 0; i < 3000; ++i) {
    const auto shapes = placed(random.some(1 + static_cast<std::size_t>(i) % 8));
    Position3 ghost = free_place(random, shapes);
    const Position3 hand = random.place(0.08);
    const bool is_open = least_between_m(shapes, ghost, hand) > 1e-4;
    const ProbeMotion motion = move_ghost(shapes, ghost, hand);
    if (!is_open) continue;
    ++reached;
    ASSERT_LE(norm(motion.ghost - hand), 1e-9) << i;
    ASSERT_TRUE(motion.planes.empty());
  }
  EXPECT_GT(reached, 500);
}

// A hand may be anywhere at once, behind the thinnest plate that there is; the ghost is never
// inside, and gets behind it on no shorter way than round its edge.
TEST(ShapeMotion, NothingIsTunnelledThroughHoweverFarTheHandJumps) {
  const auto plate = placed({{.kind = ShapeKind::Box, .half_m = {0.5, 0.0005, 0.5}}});
  RandomShapes random(2);
  Position3 ghost{0, 0.01, 0};
  for (int i = 0; i < 20'000; ++i) {
    const ProbeMotion motion = move_ghost(plate, ghost, random.place(0.3));
    ASSERT_GE(motion.ghost.y, 0.0005 - 1e-9) << i;
  }
}

TEST(ShapeMotion, TheGhostIsOutsideAndItsPlanesAreTangent) {
  RandomShapes random(3);
  std::size_t most_planes = 0;
  int held = 0;
  for (int world = 0; world < 300; ++world) {
    std::vector<Shape> shapes = random.some(1 + static_cast<std::size_t>(world) % 12);
    if (world % 3 == 0) shapes.push_back({.kind = ShapeKind::Floor, .center = {0, -0.03, 0}});
    const auto sut = placed(shapes);
    Position3 ghost = free_place(random, sut);
    for (int i = 0; i < 100; ++i) {
      const Position3 hand = random.place(0.06);
      const ProbeMotion motion = move_ghost(sut, ghost, hand);
      ASSERT_TRUE(is_finite(motion.ghost));
      ASSERT_GE(distance_m(sut, motion.ghost), -1e-7) << world << " " << i;
      ASSERT_LE(motion.planes.size(), 3U);
      most_planes = std::max(most_planes, motion.planes.size());
      for (const ContactPlane& plane : motion.planes) {
        ++held;
        ASSERT_NEAR(norm(plane.normal), 1, 1e-9);
        const double gap_m = plane.offset_m - dot(plane.normal, motion.ghost);
        ASSERT_NEAR(gap_m, 0, 2e-7) << "the ghost is on its planes";
        const Position3 beyond = motion.ghost + along<DisplacementTag>(plane.normal, 1e-5);
        ASSERT_LT(distance_m(sut, beyond), 0) << "the plane's normal points into matter";
      }
    }
  }
  EXPECT_GT(held, 4000);
  EXPECT_EQ(most_planes, 3U);
}

// Where it rests, no place that a step of 0.1 mm leads to is free, and nearer to the hand.
TEST(ShapeMotion, TheGhostRestsWhereNoWayLeadsNearer) {
  RandomShapes random(4);
  int rests = 0;
  for (int world = 0; world < 400; ++world) {
    const auto shapes = random.some(1 + static_cast<std::size_t>(world) % 6);
    const auto sut = placed(shapes);
    Position3 ghost = free_place(random, sut);
    const Position3 hand = shapes[0].center + (random.place(0.002) - Position3{});
    ProbeMotion motion;
    for (int i = 0; i < 200; ++i) motion = move_ghost(sut, ghost, hand);
    const double left_m = norm(hand - motion.ghost);
    if (left_m < 1e-3) continue;
    ++rests;
    for (int k = 0; k < 500; ++k) {
      const Position3 near = motion.ghost + 1e-4 / 0.01 * (random.place(0.01) - Position3{});
      if (distance_m(sut, near) < 1e-6) continue;
      ASSERT_GE(norm(hand - near), left_m - 1e-5) << world;
    }
  }
  EXPECT_GT(rests, 300);
}

TEST(ShapeMotion, MirroredWorldsMoveMirroredGhosts) {
  const auto run = [](double x, double z) {
    std::vector<Shape> shapes{
        {.kind = ShapeKind::Sphere, .center = {x * 0.01, 0, 0}, .radius_m = 0.02},
        {.kind = ShapeKind::Box, .center = {0, 0, z * 0.02}, .half_m = {0.02, 0.01, 0.01}},
        {.kind = ShapeKind::Floor, .center = {0, -0.02, 0}}};
    const auto sut = placed(shapes);
    RandomShapes random(5);
    Position3 ghost{0, 0.06, 0};
    std::vector<Position3> trace;
    for (int i = 0; i < 2000; ++i) {
      const Position3 hand = random.place(0.05);
      const Position3 at = move_ghost(sut, ghost, {x * hand.x, hand.y, z * hand.z}).ghost;
      trace.push_back({x * at.x, at.y, z * at.z});
    }
    return trace;
  };
  const auto reference = run(1, 1);
  EXPECT_EQ(run(-1, 1), reference);
  EXPECT_EQ(run(-1, -1), reference);
}

TEST(ShapeMotion, TheOrderOfShapesChangesNothingButRounding) {
  RandomShapes random(6);
  std::vector<Shape> shapes = random.some(6);
  const auto one = placed(shapes);
  std::reverse(shapes.begin(), shapes.end());
  const auto other = placed(shapes);
  Position3 a = free_place(random, one);
  for (int i = 0; i < 2000; ++i) {
    Position3 b = a;
    const Position3 hand = random.place(0.05);
    ASSERT_LE(norm(move_ghost(one, a, hand).ghost - move_ghost(other, b, hand).ghost), 1e-6) << i;
  }
}

TEST(ShapeWorld, AHandInMatterStartsAtAFreePlaceNearIt) {
  RandomShapes random(7);
  for (int i = 0; i < 300; ++i) {
    const Shape shape = random.any();
    auto world = ShapeWorld::create({shape});
    ASSERT_TRUE(world);
    const Position3 hand = shape.center;
    const auto probe = world->add_probe(hand);
    ASSERT_TRUE(probe) << i;
    const ProbeMotion motion = world->move_probe(*probe, hand, kStep);
    const PlacedShape sut(shape);
    EXPECT_GE(sut.look(motion.ghost).distance_m, -1e-7);
    EXPECT_LE(norm(motion.ghost - hand), 0.05) << i;
    EXPECT_FALSE(motion.planes.empty()) << i;
  }
}

TEST(ShapeWorld, AWorldWithoutAFreePlaceSaysSo) {
  const Shape up{.kind = ShapeKind::Floor, .center = {0, 1, 0}};
  const Shape down{
      .kind = ShapeKind::Floor, .center = {0, -1, 0}, .turn_rad = {3.14159265358979, 0, 0}};
  auto world = ShapeWorld::create({up, down});
  ASSERT_TRUE(world);
  EXPECT_EQ(world->add_probe({}).error().code, Errc::NotFound);
}

TEST(ShapeWorld, EachShapeHasItsSurface) {
  Shape soft{.kind = ShapeKind::Floor, .center = {0, 0, 0}};
  soft.surface = {.stiffness = {200}, .damping = {1}, .friction = 0.3, .temperature_kelvin = 310};
  auto world = ShapeWorld::create(
      {soft, {.kind = ShapeKind::Sphere, .center = {0.1, 0, 0}, .radius_m = 0.02}});
  const auto probe = world->add_probe({0, 0.01, 0});
  const ProbeMotion motion = world->move_probe(*probe, {0, -0.01, 0}, kStep);
  ASSERT_EQ(motion.planes.size(), 1U);
  EXPECT_EQ(motion.planes[0].stiffness, Stiffness{200});
  EXPECT_EQ(motion.planes[0].friction, 0.3);
  EXPECT_EQ(motion.planes[0].temperature_kelvin, 310);
}

TEST(ShapeWorld, ProbesAreBoundedAndUnknownOnesAreFree) {
  auto world = ShapeWorld::create({{.kind = ShapeKind::Floor}});
  std::vector<ProbeId> probes;
  for (std::size_t i = 0; i < kMaxProbes; ++i)
    probes.push_back(world->add_probe({0, 1, 0}).value());
  EXPECT_EQ(world->add_probe({0, 1, 0}).error().code, Errc::Busy);
  world->remove_probe(probes[3]);
  EXPECT_TRUE(world->add_probe({0, 1, 0}));
  const ProbeMotion unknown = world->move_probe(probes[3], {0, -1, 0}, kStep);
  EXPECT_EQ(unknown.ghost, (Position3{0, -1, 0}));
  EXPECT_TRUE(unknown.planes.empty());
}

TEST(ShapeWorld, AHandThatIsNotFiniteMovesNothing) {
  auto world = ShapeWorld::create({{.kind = ShapeKind::Floor}});
  EXPECT_FALSE(world->add_probe({std::nan(""), 0, 0}));
  const auto probe = world->add_probe({0, 0.01, 0});
  const ProbeMotion motion = world->move_probe(*probe, {0, std::nan(""), 0}, kStep);
  EXPECT_EQ(motion.ghost, (Position3{0, 0.01, 0}));
  EXPECT_TRUE(motion.planes.empty());
  EXPECT_TRUE(is_finite(world->move_probe(*probe, {0, -1e300, 0}, kStep).ghost));
}

TEST(ShapeWorld, RefusesNoShapesTooManyAndUnsoundOnes) {
  EXPECT_FALSE(ShapeWorld::create({}));
  EXPECT_FALSE(ShapeWorld::create(std::vector<Shape>(kMaxShapes + 1, {.radius_m = 0.01})));
  EXPECT_TRUE(ShapeWorld::create(std::vector<Shape>(kMaxShapes, {.radius_m = 0.01})));
  const auto bad = ShapeWorld::create({{.radius_m = 0.01}, {.radius_m = 0}});
  ASSERT_FALSE(bad);
  EXPECT_NE(bad.error().message.find("number 1 is not finite, or smaller than 1 mm"),
            std::string::npos);
}

}  // namespace
}  // namespace thimble::world
