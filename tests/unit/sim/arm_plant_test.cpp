#include "sim/model/arm/arm_plant.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/unit/sim/random_poses.hpp"

namespace thimble::sim {
namespace {

constexpr double kSubstep = 100e-6;
constexpr JointVector kNoTorque{};

ArmParameters frictionless(ArmParameters p) {
  p.backdrive_newton = 0;
  p.viscous_newton_s_per_m = 0;
  return p;
}

// The stops are far away and lossless, so that the arm swings freely for as long as it likes.
ArmParameters free_swinging(ArmParameters p) {
  p = frictionless(p);
  for (AngleRange& range : p.joint_range) range = {-1e9, 1e9};
  p.elbow_range = {-1e9, 1e9};
  return p;
}

void run(ArmPlant& plant, double duration_s, Force3 force = {}) {
  const auto steps = static_cast<int>(std::lround(duration_s / kSubstep));
  for (int i = 0; i < steps; ++i) plant.step(kSubstep, kNoTorque, force);
}

TEST(ArmPlant, KeepsItsEnergyWhenNothingRubsOrPushes) {
  for (ArmParameters p : all_arm_parameters()) {
    p.balance = 0.5;  // so that energy is traded between height and speed
    ArmPlant sut(free_swinging(p));
    sut.set_state(p.home_rad, {3, -2, 4});
    const double kinetic =
        sut.dynamics().kinetic_energy_j(ArmDynamics::pose(sut.joint_rad()), sut.joint_rate());
    const double before = sut.mechanical_energy_j();
    double worst = 0;

    for (int i = 0; i < 100; ++i) {
      run(sut, 0.1);
      worst = std::max(worst, std::abs(sut.mechanical_energy_j() - before));
    }

    EXPECT_LT(worst, 1e-4 * kinetic) << p.name;
  }
}

TEST(ArmPlant, KeepsItsEnergyThroughLosslessStops) {
  ArmParameters p = frictionless(phantom_vintage_parameters());
  p.stop_damping_s_per_rad = 0;
  ArmPlant sut(p);
  sut.set_state(p.home_rad, {2, 1, -2});
  const double before = sut.mechanical_energy_j();

  run(sut, 10);

  EXPECT_NEAR(sut.mechanical_energy_j(), before, 1e-4 * std::abs(before));
}

TEST(ArmPlant, NeverGainsEnergyWithFrictionAndStops) {
  for (const ArmParameters& p : all_arm_parameters()) {
    ArmPlant sut(p);
    RandomPoses random(sut.dynamics(), 11);
    for (int start = 0; start < 20; ++start) {
      sut.set_state(random.pose(), random.rate(10));
      double energy = sut.mechanical_energy_j();
      for (int i = 0; i < 4000; ++i) {
        sut.step(kSubstep, kNoTorque, {});
        const double now = sut.mechanical_energy_j();
        ASSERT_LE(now, energy + 1e-9) << p.name << " start " << start << " step " << i;
        energy = now;
      }
    }
  }
}

TEST(ArmPlant, StopsHoldAgainstTheMotorsAndAPerson) {
  const ArmParameters p = phantom_vintage_parameters();
  ArmPlant sut(p);
  RandomPoses random(sut.dynamics(), 3);
  for (int n = 0; n < 20; ++n) {
    const Force3 force{random.uniform(-8, 8), random.uniform(-8, 8), random.uniform(-8, 8)};
    run(sut, 0.5, force);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_GT(sut.joint_rad()[i], p.joint_range[i].min_rad - 0.1);
      EXPECT_LT(sut.joint_rad()[i], p.joint_range[i].max_rad + 0.1);
    }
  }
}

TEST(ArmPlant, TipVelocityIsTheRateOfTheTip) {
  ArmPlant sut(phantom_vintage_parameters());
  sut.set_state(sut.dynamics().parameters().home_rad, {1, -2, 3});
  const Velocity3 velocity = sut.tip_velocity();
  const Position3 before = sut.tip();

  sut.step(1e-6, kNoTorque, {});

  const Displacement3 moved = sut.tip() - before;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(moved[axis] / 1e-6, velocity[axis], 1e-4);
  }
}

TEST(ArmPlant, RestsUntilTheBackDriveForceIsExceeded) {
  const ArmParameters p = phantom_vintage_parameters();
  const Position3 home = ArmDynamics(p).tip(ArmDynamics::pose(p.home_rad));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Force3 force{};
    force[axis] = 0.9 * p.backdrive_newton;
    ArmPlant held(p);
    held.rest_at(p.home_rad);
    run(held, 0.2, force);
    force[axis] = 2.5 * p.backdrive_newton;
    ArmPlant moved(p);
    moved.rest_at(p.home_rad);
    run(moved, 0.2, force);

    EXPECT_LT(norm(held.tip() - home), 1e-3) << axis;
    EXPECT_GT(norm(moved.tip() - home), 3e-3) << axis;
  }
}

TEST(ArmPlant, BalancedArmStaysAndUnbalancedArmFalls) {
  ArmParameters p = free_swinging(phantom_vintage_parameters());
  const Position3 home = ArmDynamics(p).tip(ArmDynamics::pose(p.home_rad));
  ArmPlant balanced(p);
  balanced.rest_at(p.home_rad);
  p.balance = 0;
  ArmPlant falling(p);
  falling.rest_at(p.home_rad);

  run(balanced, 0.1);
  run(falling, 0.1);

  EXPECT_LT(norm(balanced.tip() - home), 1e-9);
  EXPECT_LT(falling.tip().y - home.y, -0.02);
}

}  // namespace
}  // namespace thimble::sim
