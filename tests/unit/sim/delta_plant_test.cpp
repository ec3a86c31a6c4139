#include "sim/model/falcon/delta_plant.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

namespace thimble::sim {
namespace {

constexpr double kStep_s = 1e-4;

double between(std::mt19937& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

Triple within(std::mt19937& random, double most) {
  const double x = between(random, -most, most);
  const double y = between(random, -most, most);
  return {x, y, between(random, -most, most)};
}

// A place within 5 cm of the middle of the workspace, device frame.
Triple somewhere(std::mt19937& random) {
  Triple x;
  do {
    x = within(random, 0.05);
  } while (norm(x) > 0.05);
  return x + Triple{0, 0, 0.125};
}

Triple unit(std::size_t axis) {
  Triple one{};
  one[axis] = 1;
  return one;
}
Triple column(const Matrix3& m, std::size_t i) { return {m.row[0][i], m.row[1][i], m.row[2][i]}; }
double smallest(Triple a) { return std::min({a.x, a.y, a.z}); }

class DeltaLinkageTest : public testing::Test {
 protected:
  FalconParameters p = falcon_parameters();
  DeltaLinkage sut{p};
  [[nodiscard]] std::optional<Triple> forward(Triple q, Triple near) const {
    const auto pose = sut.forward(DeltaLinkage::cranks(q), near);
    return pose ? std::optional(pose->x) : std::nullopt;
  }
  [[nodiscard]] DeltaLinkage::Constraint constrain(Triple q, Triple x) const {
    return sut.constrain(DeltaLinkage::cranks(q), x);
  }
  std::mt19937 random{4};
};

TEST_F(DeltaLinkageTest, AtItsHomeAnglesTheGripIsBeforeTheMiddle) {
  const auto x = forward({p.home_rad, p.home_rad, p.home_rad}, {0, 0, 0.12});
  ASSERT_TRUE(x);
  EXPECT_NEAR(x->x, 0, 0.003);
  EXPECT_NEAR(x->y, 0, 0.003);
  EXPECT_NEAR(x->z, 0.135, 0.001);
}

TEST_F(DeltaLinkageTest, ForwardUndoesInverse) {
  for (int i = 0; i < 2000; ++i) {
    const Triple x = somewhere(random);
    const auto q = sut.inverse(x);
    ASSERT_TRUE(q);
    EXPECT_GT(std::min({q->x, q->y, q->z}), p.crank_min_rad);
    EXPECT_LT(std::max({q->x, q->y, q->z}), p.crank_max_rad);
    const Triple near = x + within(random, 0.02);
    const auto back = forward(*q, near);
    ASSERT_TRUE(back);
    EXPECT_LT(norm(*back - x), 1e-9);
  }
}

// The sheet's own three equations of a leg, with angles of its rods that this model never uses.
TEST_F(DeltaLinkageTest, HoldsTheSheetsEquations) {
  for (int i = 0; i < 500; ++i) {
    const Triple x = somewhere(random);
    const Triple q = sut.inverse(x).value();
    for (std::size_t leg = 0; leg < 3; ++leg) {
      const double azimuth = p.azimuth_rad[leg];
      const double u = std::cos(azimuth) * x.x + std::sin(azimuth) * x.y - 0.04;
      const double v = -std::sin(azimuth) * x.x + std::cos(azimuth) * x.y + 0.02309;
      const double theta3 = std::acos((v - 0.025) / 0.1025);
      const double reach = 0.0225 + 0.1025 * std::sin(theta3);
      const double cos_theta2 = (u - 0.06 * std::cos(q[leg]) + 0.01443) / reach;
      const double sin_theta2 = (x.z - 0.06 * std::sin(q[leg])) / reach;
      EXPECT_NEAR(cos_theta2 * cos_theta2 + sin_theta2 * sin_theta2, 1, 1e-9);
    }
  }
}

TEST_F(DeltaLinkageTest, ItsDerivativesAreThoseOfItsEquations) {
  constexpr double kTiny = 1e-6;
  for (int i = 0; i < 200; ++i) {
    const Triple x = somewhere(random);
    const Triple q = sut.inverse(x).value() + within(random, 0.1);
    const auto c = constrain(q, x);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Triple d = kTiny * unit(axis);
      const Triple by_x = (constrain(q, x + d).value - constrain(q, x - d).value);
      EXPECT_LT(norm(column(c.a, axis) - 1 / (2 * kTiny) * by_x), 1e-8);
      const Triple by_q = (constrain(q + d, x).value - constrain(q - d, x).value);
      EXPECT_LT(norm(c.b[axis] * unit(axis) - 1 / (2 * kTiny) * by_q), 1e-8);
    }
    const Triple rate = within(random, 3);
    const Triple velocity = within(random, 0.5);
    constexpr double kShort_s = 1e-4;
    const auto at = [&](double t) { return constrain(q + t * rate, x + t * velocity).value; };
    const Triple second = 1 / (kShort_s * kShort_s) * (at(kShort_s) - 2.0 * at(0) + at(-kShort_s));
    EXPECT_LT(norm(sut.bias(DeltaLinkage::cranks(q), constrain(q, x), rate, velocity) - second),
              1e-6);
  }
}

TEST_F(DeltaLinkageTest, CranksThatAreTurnedAreThoseOfTheAngleThere) {
  for (int i = 0; i < 2000; ++i) {
    Triple q = within(random, 2);
    // A tenth of a radian in 0.1 ms is far beyond what a crank does.
    const Triple step = within(random, 0.1);
    const auto turned = DeltaLinkage::turned(DeltaLinkage::cranks(q), step);
    q += step;
    const auto expected = DeltaLinkage::cranks(q);
    EXPECT_LT(norm(turned.sine - expected.sine), 1e-15);
    EXPECT_LT(norm(turned.cosine - expected.cosine), 1e-15);
  }
}

TEST_F(DeltaLinkageTest, WhatIsOutOfReachHasNoPose) {
  EXPECT_FALSE(sut.inverse({0, 0, 0.3}));
  EXPECT_FALSE(sut.inverse({0.2, 0, 0.12}));
  EXPECT_FALSE(sut.inverse({0, 0, std::nan("")}));
  EXPECT_FALSE(forward({0, 0, std::nan("")}, {0, 0, 0.12}));
}

FalconParameters without_friction() {
  FalconParameters p = falcon_parameters();
  p.coulomb_newton_m = 0;
  p.viscous_newton_m_s_per_rad = 0;
  p.stop_damping_s = 0;
  return p;
}

TEST(DeltaPlant, KeepsItsEnergyWhenNothingRubsOrPushes) {
  std::mt19937 random(6);
  for (int i = 0; i < 5; ++i) {
    DeltaPlant sut(without_friction());
    ASSERT_TRUE(sut.rest_at(somewhere(random)));
    sut.set_rate(within(random, 8));
    const double before_j = sut.mechanical_energy_j();
    for (int step = 0; step < 20'000; ++step) {
      sut.step(kStep_s, {}, {});
    }
    EXPECT_NEAR(sut.mechanical_energy_j(), before_j, 2e-4) << i;
    EXPECT_EQ(sut.standstills(), 0U);
  }
}

// Also where its cranks' sines follow from those of the step before.
TEST(DeltaPlant, TheGripIsWhereItsCranksHoldItHoweverLongItSwings) {
  std::mt19937 random(9);
  DeltaPlant sut(without_friction());
  ASSERT_TRUE(sut.rest_at(somewhere(random)));
  sut.set_rate(within(random, 8));
  double farthest_m = 0;
  for (int step = 0; step < 50'000; ++step) {
    sut.step(kStep_s, {}, {});
    const auto exact = sut.linkage().forward(DeltaLinkage::cranks(sut.crank_rad()), sut.grip());
    ASSERT_TRUE(exact);
    farthest_m = std::max(farthest_m, norm(exact->x - sut.grip()));
  }
  EXPECT_LT(farthest_m, 1e-11);
}

TEST(DeltaPlant, MotorsAndHandBalanceWhereTheirForcesCancel) {
  std::mt19937 random(8);
  FalconParameters p = without_friction();
  p.gravity_m_per_s2 = 0;
  for (int i = 0; i < 100; ++i) {
    DeltaPlant sut(p);
    const Triple x = somewhere(random);
    ASSERT_TRUE(sut.rest_at(x));
    const Triple torque = within(random, 0.2);
    const Triple force = sut.force_of(torque);
    EXPECT_LT(norm(transposed_times(sut.jacobian(), force) - torque), 1e-12);
    for (int step = 0; step < 20; ++step) sut.step(kStep_s, torque, -force);
    EXPECT_LT(norm(sut.grip() - x), 1e-9);
  }
}

TEST(DeltaPlant, GivesNoMoreEnergyThanItWasGiven) {
  std::mt19937 random(9);
  DeltaPlant sut(falcon_parameters());
  ASSERT_TRUE(sut.rest_at({0, 0, 0.125}));
  double given_j = sut.mechanical_energy_j();
  for (int burst = 0; burst < 200; ++burst) {
    const Triple torque = within(random, 0.3);
    const Triple force = within(random, 10);
    for (int step = 0; step < 250; ++step) {
      const Triple q = sut.crank_rad();
      const Triple x = sut.grip();
      sut.step(kStep_s, torque, force);
      given_j += dot(torque, sut.crank_rad() - q) + dot(force, sut.grip() - x);
      ASSERT_LT(sut.mechanical_energy_j(), given_j + 1e-3);
    }
  }
  EXPECT_EQ(sut.standstills(), 0U);
}

// Full torque and a rough hand into every corner: the stops hold, and the equations stay solvable.
TEST(DeltaPlant, StaysWithinItsStopsWhateverPushes) {
  std::mt19937 random(10);
  DeltaPlant sut(falcon_parameters());
  const FalconParameters p = falcon_parameters();
  ASSERT_TRUE(sut.rest_at({0, 0, 0.125}));
  for (int burst = 0; burst < 200; ++burst) {
    Triple torque;
    for (std::size_t i = 0; i < 3; ++i) torque[i] = random() % 2 == 0 ? -0.3 : 0.3;
    const Triple force = within(random, 40);
    for (int step = 0; step < 400; ++step) {
      sut.step(kStep_s, torque, force);
      ASSERT_GT(smallest(sut.crank_rad()), p.crank_min_rad - 0.2) << burst;
      ASSERT_LT(-smallest(-sut.crank_rad()), p.crank_max_rad + 0.15) << burst;
      ASSERT_LT(std::hypot(sut.grip().x, sut.grip().y), 0.095) << burst;
    }
  }
  EXPECT_EQ(sut.standstills(), 0U);
}

TEST(DeltaPlant, DroopsAndComesToRest) {
  DeltaPlant sut(falcon_parameters());
  ASSERT_TRUE(sut.rest_at({0, 0, 0.125}));
  for (int step = 0; step < 50'000; ++step) sut.step(kStep_s, {}, {});
  EXPECT_LT(sut.grip().y, -0.01);
  EXPECT_LT(norm(sut.grip_velocity()), 1e-3);
}

TEST(DeltaPlant, RefusesPlacesOutOfReachAndStaysWhereItIs) {
  DeltaPlant sut(falcon_parameters());
  ASSERT_TRUE(sut.rest_at({0.01, 0, 0.13}));
  for (const Triple& x : {Triple{0, 0, 0.25}, Triple{0.08, 0, 0.12}, Triple{0, 0, 0.04},
                          Triple{std::nan(""), 0, 0.1}}) {
    EXPECT_FALSE(sut.rest_at(x));
    EXPECT_EQ(sut.grip(), (Triple{0.01, 0, 0.13}));
  }
}

}  // namespace
}  // namespace thimble::sim
