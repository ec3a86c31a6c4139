#include "daemon/coupling/energy_observer.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <random>
#include <string>

#include "daemon/coupling/ghost_point_world.hpp"
#include "daemon/coupling/passivity_guard.hpp"
#include "daemon/coupling/scheme.hpp"
#include "daemon/coupling/steady_force.hpp"
#include "daemon/world/voxel_world.hpp"
#include "hand_samples.hpp"
#include "linked_loop.hpp"

namespace thimble::coupling {
namespace {

using testing::kTick;
using testing::LinkedLoop;

TEST(EnergyObserver, SpringGivesBackWhatItTookAndGeneratesNothing) {
  EnergyObserver sut;
  for (int i = 0; i < 100; ++i) sut.add({-1, 0, 0}, {0.1, 0, 0}, kTick);
  EXPECT_NEAR(sut.given_joule(), -0.01, 1e-12);
  for (int i = 0; i < 100; ++i) sut.add({-1, 0, 0}, {-0.1, 0, 0}, kTick);
  EXPECT_NEAR(sut.given_joule(), 0, 1e-12);
  EXPECT_NEAR(sut.generated_joule(), 0, 1e-12);
}

TEST(EnergyObserver, RemembersTheMostThatWasGenerated) {
  EnergyObserver sut;
  sut.add({0, 2, 0}, {0, 0.5, 0}, kTick);
  sut.add({0, 2, 0}, {0, -5, 0}, kTick);
  EXPECT_NEAR(sut.generated_joule(), 0.001, 1e-12);
  EXPECT_NEAR(sut.given_joule(), -0.009, 1e-12);
}

TEST(PortObserver, WhatIsNotFiniteMovesNothing) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  PortObserver sut;
  sut.reset({kNan, 0, 0});
  sut.observe({0.1, 0, 0}, {2, 0, 0});
  EXPECT_EQ(sut.given_joule(), 0) << "nothing was held before";
  sut.observe({kNan, 0, 0}, {2, 0, 0});
  sut.observe({0.5, 0, 0}, {kNan, 0, 0});
  sut.observe({0.7, 0, 0}, {1e308, 0, 0});
  sut.observe({1e9, 0, 0}, {1, 0, 0});
  sut.observe({1e9 + 1, 0, 0}, {});
  EXPECT_EQ(sut.given_joule(), 1);
}

// Of every arm half there is, and of what may stand around one.
std::vector<std::unique_ptr<ArmCoupling>> every_arm_half() {
  std::vector<std::unique_ptr<ArmCoupling>> halves;
  for (const Scheme scheme : kSchemes) halves.push_back(make_arm_coupling(scheme, {}));
  halves.push_back(std::make_unique<PassivityGuard>(make_arm_coupling(Scheme::RemoteForce, {}),
                                                    PassivitySettings{}));
  halves.push_back(std::make_unique<SteadyForce>(make_arm_coupling(Scheme::GhostPoint, {})));
  return halves;
}

std::unique_ptr<WorldCoupling> world_half(std::size_t half, world::World& world) {
  const Scheme scheme = half < kSchemes.size() ? kSchemes[half] : Scheme::RemoteForce;
  if (!has_own_world_half(scheme)) return std::make_unique<GhostPointWorld>(world, 1);
  return make_own_world_half(scheme, {}, world, 1).value();
}

// Oracle: the sum of F·v·dt outside, v the mean velocity of the tip in the step for which F is
// held.
TEST(PortObserver, OfEveryArmHalfAgreesWithWhatIsAddedUpOutside) {
  std::mt19937_64 random(455);
  std::uniform_real_distribution<double> any(-1, 1);
  std::vector<std::unique_ptr<ArmCoupling>> halves = every_arm_half();
  for (std::size_t half = 0; half < halves.size(); ++half) {
    world::VoxelWorld room(world::make_box(3).value(), "box:3");
    const std::unique_ptr<WorldCoupling> world = world_half(half, room);
    LinkedLoop loop(*halves[half], *world, kTick, {.delay_s = 0.01, .jitter_s = 0.004});
    double outside_joule = 0;
    double most_joule = 0;
    double worked_joule = 0;
    Force3 held{};
    Position3 tip{};
    Velocity3 velocity{};
    for (int i = 0; i < 2000; ++i) {
      // To and fro across the walls of the box, 15 mm away, by a path that jerks.
      for (std::size_t axis = 0; axis < 3; ++axis) {
        velocity[axis] += 0.08 * any(random) - 1e-3 * (250 * tip[axis] + 20 * velocity[axis]);
      }
      const Displacement3 moved{1e-3 * velocity.x, 1e-3 * velocity.y, 1e-3 * velocity.z};
      tip = tip + moved;
      const double joule = dot(held, velocity) * 1e-3;
      outside_joule += joule;
      worked_joule += std::abs(joule);
      most_joule = std::max(most_joule, outside_joule);
      held = loop.tick(tip, velocity).force;
    }
    EXPECT_GT(worked_joule, 0.001) << half;
    EXPECT_NEAR(halves[half]->energy().given_joule(), outside_joule, 1e-9) << half;
    EXPECT_NEAR(halves[half]->energy().generated_joule(), most_joule, 1e-9) << half;
    halves[half]->reset({}, tip);
    EXPECT_EQ(halves[half]->energy().generated_joule(), 0) << half;
  }
}

}  // namespace
}  // namespace thimble::coupling
