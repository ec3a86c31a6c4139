#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "arm_bench.hpp"
#include "daemon/coupling/constraint_plane_arm.hpp"
#include "tests/support/random_planes.hpp"

namespace thimble::coupling {
namespace {

using test::RandomPlanes;
using testing::ArmBench;
using testing::wall;
using testing::without_spring;
using world::PastPlanes;
using world::project;
using PlaneArmBench = testing::BenchOf<ConstraintPlaneArm, ConstraintPlaneSettings>;

constexpr double kInside_m = 0.0005;  // hysteresis

// A hand that wanders from goal to goal.
class Wanderer {
 public:
  explicit Wanderer(std::uint32_t seed, double step_m) : dice_(seed), step_m_(step_m) {}
  Position3 move() {
    if (dice_.below(150) == 0) goal_ = Position3{} + dice_.displacement(0.02);
    for (std::size_t axis = 0; axis < 3; ++axis)
      tip_[axis] += std::clamp(goal_[axis] - tip_[axis], -step_m_, step_m_);
    return tip_;
  }

 private:
  RandomPlanes dice_;
  double step_m_;
  Position3 tip_{};
  Position3 goal_{};
};

// Any set of planes that leaves a place free near the hand, told late, changed at any time.
class AnyWalls {
 public:
  explicit AnyWalls(std::uint32_t seed) : dice_(seed) {}
  void change(Position3 hand) {
    planes_.clear();
    for (const auto& [normal, past_m] : dice_.around_a_free_place(dice_.below(5))) {
      ConstraintPlane plane = wall(normal, dot(normal, hand) - past_m);
      if (dice_.below(2) == 0) plane.surface.stiffness = {dice_.uniform(100, 1000)};
      planes_.push_back(plane);
    }
  }
  // One wall moves a little, as that of a curved surface does.
  void nudge() {
    if (planes_.empty()) return;
    ConstraintPlane& plane = planes_[dice_.below(planes_.size())];
    const Direction3 turned = plane.normal + along<struct DirectionTag>(dice_.direction(), 0.05);
    plane.normal = (1 / norm(turned)) * turned;
    plane.offset_m += dice_.uniform(-0.001, 0.001);
  }
  [[nodiscard]] const std::vector<ConstraintPlane>& planes() const { return planes_; }
  [[nodiscard]] bool chance(std::size_t one_in) { return dice_.below(one_in) == 0; }

 private:
  RandomPlanes dice_;
  std::vector<ConstraintPlane> planes_;
};

// The part of `force` that the planes could not push: 0 if it lies in the cone of their normals.
double pulled_newton(const std::vector<ConstraintPlane>& planes, Force3 force) {
  PastPlanes cone;
  for (const ConstraintPlane& plane : planes)
    cone.push_back({plane.normal, -dot(plane.normal, force)});
  const Displacement3 pushed = project(cone).past;
  return norm(force.x + pushed.x, force.y + pushed.y, force.z + pushed.z);
}

TEST(ConstraintPlaneProperty, NoReplyKicksAndNoForceAttracts) {
  constexpr double kStep_m = 0.0001;
  ConstraintPlaneSettings settings;
  settings.max_offset_m = 1000;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    AnyWalls walls(seed);
    Wanderer hand(seed, kStep_m);
    PlaneArmBench bench(settings);
    ArmOutput last{};
    for (int i = 0; i < 5000; ++i) {
      if (walls.chance(50)) walls.change(last.sample.hand);
      if (walls.chance(5)) walls.nudge();
      if (walls.chance(300)) ++bench.session;
      const std::uint64_t news = bench.sut.counters().news;
      const ArmOutput out = bench.told(hand.move(), walls.planes());
      ASSERT_LE(pulled_newton(walls.planes(), out.force), 1e-6) << seed << " tick " << i;
      const auto told = static_cast<double>(bench.sut.counters().news - news);
      const double step_newton = 1000 * (std::sqrt(told) * kInside_m + 2 * kStep_m);
      ASSERT_LE(norm(out.force), norm(last.force) + step_newton) << seed << " tick " << i;
      last = out;
    }
    EXPECT_GT(bench.sut.counters().late_walls, 50U);
  }
}

// Energy of the offset: what is news gives ½·K·H², whatever else happens; a trapezoid over one
// step is wrong by less than the rest.
TEST(ConstraintPlaneProperty, TheOffsetGivesTheHandNoMoreThanItsNewsStored) {
  constexpr double kStep_m = 0.00005;
  constexpr double kNews_joule = 0.5 * 1000 * kInside_m * kInside_m;
  constexpr double kTouch_joule = 1000 * 3 * kStep_m * kStep_m;
  int touches = 0;
  double worst = 0;
  for (std::uint32_t seed = 1; seed <= 100; ++seed) {
    AnyWalls walls(seed);
    Wanderer hand(1000 + seed, kStep_m);
    ConstraintPlaneSettings settings;
    settings.max_offset_m = 1000;
    PlaneArmBench bench(settings);
    ArmOutput last{};
    Position3 before{};
    double given_joule = 0;
    double allowed_joule = kTouch_joule;
    for (int i = 0; i < 5000; ++i) {
      if (walls.chance(200)) walls.change(last.sample.hand);
      if (walls.chance(100)) walls.nudge();
      const std::uint64_t news = bench.sut.counters().news;
      const Position3 tip = hand.move();
      const ArmOutput out = bench.told(tip, walls.planes());
      const auto told = static_cast<double>(bench.sut.counters().news - news);
      // The step in which something became news is the hand's at the new force.
      allowed_joule += told * (kNews_joule + 1000 * kInside_m * kStep_m);
      given_joule += dot(0.5 * (last.force + out.force), tip - before);
      ASSERT_LE(given_joule, allowed_joule) << seed << " tick " << i;
      worst = std::max(worst, given_joule / allowed_joule);
      before = tip;
      last = out;
      if (norm(out.force) > 0) continue;
      if (given_joule != 0) ++touches;
      given_joule = 0;
      allowed_joule = kTouch_joule;
    }
  }
  EXPECT_GT(touches, 500);
  EXPECT_GT(worst, 0.05) << "the bound is idle";
}

TEST(ConstraintPlaneProperty, RecoveryInjectsNoMoreThanTheWallsDoOnTheirWay) {
  constexpr double kStep_m = 0.00005;
  constexpr double kNews_joule = 0.5 * 1000 * kInside_m * kInside_m;
  constexpr double kTouch_joule = 1000 * 3 * kStep_m * kStep_m;
  ConstraintPlaneSettings settings;
  settings.late_walls = LateWalls::Recovery;
  double injected_joule = 0;
  for (std::uint32_t seed = 1; seed <= 50; ++seed) {
    AnyWalls walls(seed);
    Wanderer hand(1000 + seed, kStep_m);
    PlaneArmBench bench(settings);
    ArmOutput last{};
    Position3 before{};
    double given_joule = 0;
    double allowed_joule = kTouch_joule;
    for (int i = 0; i < 5000; ++i) {
      if (walls.chance(200)) walls.change(last.sample.hand);
      const std::uint64_t news = bench.sut.counters().news;
      const Displacement3 behind = bench.sut.recovery();
      const Position3 tip = hand.move();
      const ArmOutput out = bench.told(tip, walls.planes());
      ASSERT_EQ(out.offset, Displacement3{});
      const auto told = static_cast<double>(bench.sut.counters().news - news);
      allowed_joule += told * (kNews_joule + 1000 * kInside_m * kStep_m);
      // Of a tick in which a wall was told late, what it then slid.
      const double slid_m = told > 0 ? 0.25 * 0.01 : norm(behind - bench.sut.recovery());
      allowed_joule += 1.05 * std::max(norm(out.force), norm(last.force)) * slid_m;
      given_joule += dot(0.5 * (last.force + out.force), tip - before);
      ASSERT_LE(given_joule, allowed_joule) << seed << " tick " << i;
      injected_joule = std::max(injected_joule, given_joule);
      before = tip;
      last = out;
      if (norm(out.force) > 0) continue;
      given_joule = 0;
      allowed_joule = kTouch_joule;
    }
  }
  EXPECT_GT(injected_joule, 100 * kNews_joule) << "recovery does inject: more than any offset may";
}

// Walls across the axes: the ghost point's frame, and its force.
TEST(ConstraintPlaneProperty, AcrossTheAxesItIsTheGhostPoint) {
  GhostPointSettings ghost_settings = without_spring();
  ghost_settings.max_offset_m = 1000;
  ConstraintPlaneSettings plane_settings;
  plane_settings.max_offset_m = 1000;
  int shifts = 0;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    RandomPlanes dice(seed);
    Wanderer hand(seed, 0.0002);
    ArmBench ghost(ghost_settings);
    PlaneArmBench sut(plane_settings);
    std::array<std::vector<ConstraintPlane>, 3> walls;
    ArmOutput last{};
    for (int i = 0; i < 5000; ++i) {
      if (dice.below(40) == 0) {
        const std::size_t axis = dice.below(3);
        Direction3 normal{};
        normal[axis] = dice.below(2) == 0 ? 1 : -1;
        walls[axis].clear();
        if (dice.below(4) > 0) {
          const double d_m = dot(normal, last.sample.hand) - dice.uniform(-0.005, 0.02);
          walls[axis].push_back(wall(normal, d_m));
        }
      }
      std::vector<ConstraintPlane> planes;
      for (const auto& one : walls) planes.insert(planes.end(), one.begin(), one.end());
      const Position3 tip = hand.move();
      const bool is_silent = i % 1000 > 600;
      const ArmOutput expected = is_silent ? ghost.alone(tip) : ghost.told(tip, planes);
      const ArmOutput got = is_silent ? sut.alone(tip) : sut.told(tip, planes);
      ASSERT_NEAR(norm(got.offset - expected.offset), 0, 1e-12) << seed << " tick " << i;
      ASSERT_NEAR(norm(got.force - expected.force), 0, 1e-9) << seed << " tick " << i;
      ASSERT_EQ(got.sample.hand.x, expected.sample.hand.x);
      if (got.offset != last.offset) ++shifts;
      last = got;
    }
  }
  EXPECT_GT(shifts, 10'000);
}

}  // namespace
}  // namespace thimble::coupling
