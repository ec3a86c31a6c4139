#include "daemon/world/sphere_world.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace thimble::world {
namespace {

constexpr double kRounding_m = 1e-12;
constexpr Duration kStep = std::chrono::milliseconds(1);
constexpr SphereScene kResting{{0.003, -0.025, -0.002}, 0.02, -0.045};

// A ball that rests, hovers, is cut below and above its middle.
std::array<SphereScene, 4> scenes() {
  std::array<SphereScene, 4> out{kResting, kResting, kResting, kResting};
  out[1].floor_m = -0.05;
  out[2].floor_m = -0.035;
  out[3].floor_m = -0.015;
  return out;
}

double uniform(std::mt19937& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

Position3 random_place(std::mt19937& random, const SphereScene& scene, double reach_m) {
  return {scene.center.x + uniform(random, -reach_m, reach_m),
          scene.center.y + uniform(random, -reach_m, reach_m),
          scene.center.z + uniform(random, -reach_m, reach_m)};
}

bool is_outside(const SphereScene& scene, Position3 p) {
  return p.y >= scene.floor_m && norm(p - scene.center) >= scene.radius_m - kRounding_m;
}

struct Hand {
  explicit Hand(const SphereScene& scene, Position3 at = {0, 0.01, 0})
      : world(SphereWorld::create(scene).value()), probe(world.add_probe(at).value()) {}
  ProbeMotion go(Position3 to) { return world.move_probe(probe, to, kStep); }
  SphereWorld world;
  ProbeId probe;
};

// Creeps towards the hand in steps of ten micrometres, pushed out of both surfaces after each.
Position3 creep(const SphereScene& scene, Position3 at, Position3 hand) {
  constexpr double kCreep_m = 1e-5;
  for (int step = 0; step < 300000; ++step) {
    const Displacement3 rest = hand - at;
    const double left_m = norm(rest);
    if (left_m == 0) break;
    const Position3 before = at;
    at = at + std::min(1.0, kCreep_m / left_m) * rest;
    for (int round = 0; round < 20; ++round) {
      const Displacement3 out = at - scene.center;
      const double from_center_m = norm(out);
      if (from_center_m < scene.radius_m) {
        at = scene.center + (scene.radius_m / from_center_m) * out;
      }
      at.y = std::max(at.y, scene.floor_m);
    }
    if (norm(at - before) < 1e-10) break;
  }
  return at;
}

TEST(SphereWorld, FreeSpaceLeavesTheGhostAtTheHand) {
  Hand sut(kResting);
  for (const Position3 at : {Position3{0, 0, 0}, {0.04, -0.04, 0.03}, {-0.5, 0.5, 0.5}}) {
    const ProbeMotion motion = sut.go(at);
    EXPECT_EQ(motion.ghost, at);
    EXPECT_TRUE(motion.planes.empty());
  }
}

TEST(SphereWorld, TheTopOfTheBallHoldsAFingerByItsTangentPlane) {
  Hand sut(kResting, {0.003, 0.01, -0.002});
  const ProbeMotion motion = sut.go({0.003, -0.010, -0.002});
  EXPECT_NEAR(motion.ghost.y, -0.005, kRounding_m);
  ASSERT_EQ(motion.planes.size(), 1U);
  EXPECT_NEAR(motion.planes[0].normal.y, -1, 1e-12);
  EXPECT_NEAR(motion.planes[0].offset_m, 0.005, kRounding_m);
}

TEST(SphereWorld, TheFloorHoldsAFingerBesideTheBall) {
  Hand sut(kResting, {0.04, 0, 0});
  const ProbeMotion motion = sut.go({0.035, -0.06, 0.001});
  EXPECT_EQ(motion.ghost, (Position3{0.035, -0.045, 0.001}));
  ASSERT_EQ(motion.planes.size(), 1U);
  EXPECT_EQ(motion.planes[0].normal, (Direction3{0, -1, 0}));
  EXPECT_EQ(motion.planes[0].offset_m, 0.045);
}

TEST(SphereWorld, BetweenBallAndFloorEachHoldsOnItsOwnSide) {
  Hand sut(kResting, {0.04, -0.044, -0.002});
  const Position3 in_gap{0.013, -0.0435, -0.002};
  EXPECT_EQ(sut.go(in_gap).ghost, in_gap);
  const ProbeMotion up = sut.go({0.013, -0.035, -0.002});
  ASSERT_EQ(up.planes.size(), 1U);
  EXPECT_GT(up.planes[0].normal.y, 0.5) << "the ball is above the finger";
  const ProbeMotion down = sut.go({0.013, -0.05, -0.002});
  ASSERT_EQ(down.planes.size(), 1U);
  EXPECT_EQ(down.planes[0].normal, (Direction3{0, -1, 0}));
}

TEST(SphereWorld, WhereTheFloorCutsTheBallBothHold) {
  SphereScene cut = kResting;
  cut.floor_m = -0.035;
  Hand sut(cut, {0.04, 0, -0.002});
  const ProbeMotion motion = sut.go({0.010, -0.045, -0.002});
  EXPECT_EQ(motion.planes.size(), 2U);
  EXPECT_EQ(motion.ghost.y, -0.035);
  EXPECT_NEAR(norm(motion.ghost - cut.center), 0.02, kRounding_m);
}

TEST(SphereWorld, AFingerPassesTheOnePointWhereTheBallRests) {
  SphereScene scene{{0, -0.025, 0}, 0.02, -0.045};
  Hand sut(scene, {0.03, -0.044, 0});
  sut.go({0.02, -0.05, 0});
  for (double x_m = 0.02; x_m > -0.02; x_m -= 0.0001) sut.go({x_m, -0.05, 0});
  EXPECT_NEAR(sut.go({-0.02, -0.05, 0}).ghost.x, -0.02, kRounding_m);
}

TEST(SphereWorld, AGhostGoesRoundTheBallNotThroughIt) {
  Hand sut(kResting, {0.003, 0.01, -0.002});
  sut.go({0.003, -0.024, -0.002});  // deep, a little above the centre
  const ProbeMotion motion = sut.go({0.004, -0.024, -0.002});
  EXPECT_GT(motion.ghost.x, 0.01);
  const ProbeMotion behind = sut.go({0.003, -0.024, -0.002});
  EXPECT_GT(behind.ghost.y, -0.024) << "and comes back on the near side";
}

TEST(SphereWorld, AHandDeadOnTheCentreLeavesTheGhostWhereItIs) {
  Hand sut(kResting, {0.003, 0.01, -0.002});
  const Position3 top = sut.go({0.003, -0.010, -0.002}).ghost;
  const ProbeMotion motion = sut.go(kResting.center);
  EXPECT_EQ(motion.ghost, top);
  EXPECT_TRUE(motion.planes.empty() || motion.planes[0].normal.y < 0);
}

TEST(SphereWorld, AHandThatIsNotFiniteMovesNothing) {
  Hand sut(kResting);
  const Position3 before = sut.go({0.01, 0.01, 0.01}).ghost;
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    const ProbeMotion motion = sut.go({0, bad, 0});
    EXPECT_EQ(motion.ghost, before);
    EXPECT_TRUE(motion.planes.empty());
    EXPECT_FALSE(sut.world.add_probe({bad, 0, 0}));
  }
  EXPECT_TRUE(is_finite(sut.go({1e300, -1e300, 1e300}).ghost));
}

TEST(SphereWorld, StartsAtTheNearestFreePlace) {
  std::mt19937 random(3);
  for (const SphereScene& scene : scenes()) {
    for (int i = 0; i < 5000; ++i) {
      const Position3 hand = random_place(random, scene, 0.03);
      const SphereGhost sut = place_ghost(scene, hand);
      ASSERT_TRUE(is_outside(scene, sut.position));
      const double moved_m = is_outside(scene, hand) ? norm(sut.position - hand) : 0;
      ASSERT_LE(moved_m, kRounding_m);
      // Nothing that is free lies nearer.
      for (int j = 0; j < 20; ++j) {
        const Position3 other = random_place(random, scene, 0.03);
        if (!is_outside(scene, other)) continue;
        ASSERT_LE(norm(sut.position - hand), norm(other - hand) + kRounding_m);
      }
    }
  }
  EXPECT_NEAR(place_ghost(kResting, kResting.center).position.y, -0.005, kRounding_m);
}

// What is left of the pull when the planes have taken their share of it, each only pushing.
double unheld_m(Displacement3 pull, const ProbeMotion& motion) {
  if (motion.planes.empty()) return norm(pull);
  if (motion.planes.size() == 1) {
    const Direction3 n = motion.planes[0].normal;
    return norm(pull - along<DisplacementTag>(n, std::max(0.0, dot(n, pull))));
  }
  const Direction3 a = motion.planes[0].normal;
  const Direction3 b = motion.planes[1].normal;
  const double cosine = dot(a, b);
  const double share_a = (dot(a, pull) - cosine * dot(b, pull)) / (1 - cosine * cosine);
  const double share_b = (dot(b, pull) - cosine * dot(a, pull)) / (1 - cosine * cosine);
  if (share_a < -kRounding_m || share_b < -kRounding_m) return norm(pull);
  return norm(pull - along<DisplacementTag>(a, share_a) - along<DisplacementTag>(b, share_b));
}

TEST(SphereWorld, RandomProgramsStayOutsideComeNearerAndAreHeldByTheirPlanesAlone) {
  std::mt19937 random(7);
  std::array<int, 3> by_planes{};
  for (const SphereScene& scene : scenes()) {
    Hand sut(scene, {0, 0.02, 0});
    Position3 ghost{0, 0.02, 0};
    for (int i = 0; i < 100000; ++i) {
      const bool is_near = random() % 4 != 0;
      const Position3 hand = is_near ? ghost + (random_place(random, scene, 0.004) - scene.center)
                                     : random_place(random, scene, 0.05);
      const ProbeMotion motion = sut.go(hand);
      ASSERT_TRUE(is_outside(scene, motion.ghost)) << i;
      ASSERT_LE(norm(motion.ghost - hand), norm(ghost - hand) + kRounding_m) << i;
      ASSERT_LT(unheld_m(hand - motion.ghost, motion), 1e-9) << i;
      for (const ContactPlane& plane : motion.planes) {
        ASSERT_NEAR(norm(plane.normal), 1, 1e-12);
        ASSERT_NEAR(dot(plane.normal, motion.ghost), plane.offset_m, kRounding_m);
      }
      ++by_planes[motion.planes.size()];
      ghost = motion.ghost;
    }
  }
  EXPECT_GT(by_planes[0], 50000);
  EXPECT_GT(by_planes[1], 50000);
  EXPECT_GT(by_planes[2], 500);
}

TEST(SphereWorld, GoesWhereCreepingGoes) {
  std::mt19937 random(11);
  int held = 0;
  for (const SphereScene& scene : scenes()) {
    for (int i = 0; i < 60; ++i) {
      const Position3 start = place_ghost(scene, random_place(random, scene, 0.03)).position;
      const Position3 hand = random_place(random, scene, 0.03);
      const Displacement3 to_center = hand - scene.center;
      // Near the centre a little decides on which side it comes out.
      if (norm(to_center) < 0.3 * scene.radius_m) continue;
      SphereGhost ghost{start, false, false};
      const ProbeMotion sut = move_ghost(scene, ghost, hand);
      ASSERT_NEAR(norm(sut.ghost - creep(scene, start, hand)), 0, 1e-4) << i;
      if (!sut.planes.empty()) ++held;
    }
  }
  EXPECT_GT(held, 50);
}

TEST(SphereWorld, RefusesAWorldThatCannotBe) {
  for (const SphereScene& scene :
       {SphereScene{{}, 0, -1}, SphereScene{{}, -1, -1}, SphereScene{{}, 0.02, 0.02},
        SphereScene{{}, std::numeric_limits<double>::infinity(), 0},
        SphereScene{{0, std::nan(""), 0}, 0.02, -1}, SphereScene{{}, 0.02, std::nan("")}}) {
    const auto sut = SphereWorld::create(scene);
    ASSERT_FALSE(sut);
    EXPECT_EQ(sut.error().code, Errc::InvalidArgument);
    EXPECT_TRUE(sut.error().message.starts_with("sphere: ")) << sut.error().message;
  }
}

TEST(SphereWorld, HasNoCellsRoomForEightProbesAndOneSurface) {
  SphereWorld sut = SphereWorld::create(kResting, {{500}, {2}, 0.3, 300}).value();
  EXPECT_EQ(sut.grid(), nullptr);
  EXPECT_EQ(sut.info().cell_m, 0);
  EXPECT_EQ(sut.info().sphere->radius_m, kResting.radius_m);
  std::vector<ProbeId> probes;
  for (std::size_t i = 0; i < kMaxProbes; ++i) {
    probes.push_back(sut.add_probe({0, 0.01, 0}).value());
  }
  EXPECT_EQ(sut.add_probe({}).error().code, Errc::Busy);
  const ProbeMotion motion = sut.move_probe(probes[3], {0.003, -0.01, -0.002}, kStep);
  ASSERT_EQ(motion.planes.size(), 1U);
  EXPECT_EQ(motion.planes[0].stiffness.newton_per_m, 500);
  EXPECT_EQ(motion.planes[0].damping.newton_s_per_m, 2);
  EXPECT_EQ(motion.planes[0].friction, 0.3);
  EXPECT_EQ(motion.planes[0].temperature_kelvin, 300);
  sut.remove_probe(probes[3]);
  EXPECT_TRUE(sut.move_probe(probes[3], {0.003, -0.01, -0.002}, kStep).planes.empty());
  EXPECT_TRUE(sut.add_probe({}));
}

}  // namespace
}  // namespace thimble::world
