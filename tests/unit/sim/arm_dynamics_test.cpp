#include "sim/model/arm/arm_dynamics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/unit/sim/random_poses.hpp"

namespace thimble::sim {
namespace {

constexpr int kPoses = 300;

class ArmDynamicsOf : public testing::TestWithParam<ArmParameters> {
 protected:
  ArmDynamics sut{GetParam()};
  RandomPoses random{sut, 7};

  JointVector shifted(JointVector q, std::size_t i, double by) {
    q[i] += by;
    return q;
  }
  Position3 tip(const JointVector& q) { return sut.tip(ArmDynamics::pose(q)); }
};

std::string model_name(const testing::TestParamInfo<ArmParameters>& info) {
  std::string name(info.param.name);
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == '-' || c == '.'; }, '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Models, ArmDynamicsOf, testing::ValuesIn(all_arm_parameters()),
                         model_name);

TEST_P(ArmDynamicsOf, ReachesACubeAboutTheOriginFromTheHomePose) {
  // 128 mm for the PHANToM: the thesis's 90 mm workspace with a margin all round.
  ASSERT_TRUE(sut.is_within_stops(GetParam().home_rad));
  for (const double x : {-0.064, 0.0, 0.064}) {
    for (const double y : {-0.064, 0.0, 0.064}) {
      for (const double z : {-0.064, 0.0, 0.064}) {
        const std::optional<JointVector> q = sut.inverse({x, y, z});
        ASSERT_TRUE(q.has_value()) << x << ' ' << y << ' ' << z;
        EXPECT_NEAR(norm(tip(*q) - Position3{x, y, z}), 0, 1e-12);
      }
    }
  }
}

TEST_P(ArmDynamicsOf, FollowsTheFactSheetsForwardKinematics) {
  const ArmParameters& p = GetParam();
  for (int n = 0; n < kPoses; ++n) {
    const JointVector q = random.pose();
    const double radial = p.link_m[1] * std::sin(q[1]) + p.link_m[2] * std::sin(q[2]);
    const double x_dev = std::cos(q[0]) * radial - p.origin_m[0];
    const double y_dev = std::sin(q[0]) * radial - p.origin_m[1];
    const double z_dev =
        p.link_m[0] + p.link_m[1] * std::cos(q[1]) - p.link_m[2] * std::cos(q[2]) - p.origin_m[2];

    const Position3 actual = tip(q);

    EXPECT_NEAR(actual.x, y_dev, 1e-12);
    EXPECT_NEAR(actual.y, z_dev, 1e-12);
    EXPECT_NEAR(actual.z, x_dev, 1e-12);
  }
}

TEST_P(ArmDynamicsOf, ATurnedPoseIsThePoseOfTheTurnedAngles) {
  for (const double step_rad : {0.0, 1e-6, -1e-3, 0.03, -0.031, 0.5}) {
    for (int n = 0; n < kPoses; ++n) {
      const JointVector q = random.pose();
      const JointVector step{step_rad, -step_rad, step_rad / 3};
      const ArmDynamics::Pose turned = ArmDynamics::turned(ArmDynamics::pose(q), step);
      const ArmDynamics::Pose exact =
          ArmDynamics::pose({q[0] + step[0], q[1] + step[1], q[2] + step[2]});
      EXPECT_NEAR(turned.sin_a, exact.sin_a, 4e-16) << step_rad;
      EXPECT_NEAR(turned.cos_a, exact.cos_a, 4e-16) << step_rad;
      EXPECT_NEAR(turned.sin_b, exact.sin_b, 4e-16) << step_rad;
      EXPECT_NEAR(turned.cos_b, exact.cos_b, 4e-16) << step_rad;
      EXPECT_NEAR(turned.sin_c, exact.sin_c, 4e-16) << step_rad;
      EXPECT_NEAR(turned.cos_c, exact.cos_c, 4e-16) << step_rad;
    }
  }
}

TEST_P(ArmDynamicsOf, JacobianIsTheSlopeOfTheTip) {
  constexpr double kStep = 1e-6;
  for (int n = 0; n < kPoses; ++n) {
    const JointVector q = random.pose();
    const TipJacobian j = sut.jacobian(ArmDynamics::pose(q));
    for (std::size_t i = 0; i < 3; ++i) {
      const Displacement3 slope = tip(shifted(q, i, kStep)) - tip(shifted(q, i, -kStep));
      for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(j[axis][i], slope[axis] / (2 * kStep), 1e-8);
      }
    }
  }
}

TEST_P(ArmDynamicsOf, TorqueOfAForceDoesTheSameWork) {
  for (int n = 0; n < kPoses; ++n) {
    const ArmDynamics::Pose pose = ArmDynamics::pose(random.pose());
    const JointVector rate = random.rate(5);
    const Force3 force{random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(-5, 5)};
    const TipJacobian j = sut.jacobian(pose);
    double tip_power = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      tip_power +=
          force[axis] * (j[axis][0] * rate[0] + j[axis][1] * rate[1] + j[axis][2] * rate[2]);
    }

    const JointVector torque = sut.torque_of(pose, force);

    EXPECT_NEAR(torque[0] * rate[0] + torque[1] * rate[1] + torque[2] * rate[2], tip_power, 1e-11);
    const Force3 back = sut.force_of(pose, torque);
    EXPECT_NEAR(norm(back - force), 0, 1e-9);
  }
}

TEST_P(ArmDynamicsOf, InverseKinematicsFindsThePose) {
  for (int n = 0; n < kPoses; ++n) {
    const JointVector q = random.pose();
    // The long arm can reach over its head; the inverse only knows what lies before the waist.
    const auto& link_m = GetParam().link_m;
    if (link_m[1] * std::sin(q[1]) + link_m[2] * std::sin(q[2]) <= 0) continue;

    const std::optional<JointVector> found = sut.inverse(tip(q));

    // A pose has one tip; a tip may have a second pose on the far side of the turret's axis.
    ASSERT_TRUE(found.has_value());
    EXPECT_NEAR(norm(tip(*found) - tip(q)), 0, 1e-12);
    EXPECT_TRUE(sut.is_within_stops(*found));
  }
}

TEST_P(ArmDynamicsOf, InverseKinematicsRefusesWhatIsOutOfReach) {
  EXPECT_FALSE(sut.inverse({0, 0, 2}).has_value());
  EXPECT_FALSE(sut.inverse({0, 0, -GetParam().origin_m[0]}).has_value());
  EXPECT_FALSE(sut.inverse({std::nan(""), 0, 0}).has_value());
}

TEST_P(ArmDynamicsOf, MassMatrixIsPositiveDefiniteOverTheWorkspace) {
  for (int n = 0; n < 3000; ++n) {
    const MassMatrix m = sut.mass_matrix(ArmDynamics::pose(random.pose()));

    EXPECT_GT(m.aa, 0);
    EXPECT_GT(m.bb, 0);
    EXPECT_GT(m.bb * m.cc - m.bc * m.bc, 0);
  }
}

TEST_P(ArmDynamicsOf, KineticEnergyIsThatOfTheMovingMasses) {
  // Every rod and the stylus cut into slices, moved by a difference quotient; counterweights
  // as points opposite their link. Uses nothing of the model but the parameters.
  const ArmParameters& p = GetParam();
  const double outer_kg = p.forearm_kg + p.tip_kg;
  const double upper_moment = p.upper_arm_kg * p.link_m[1] / 2 + outer_kg * p.link_m[1];
  const double fore_moment = p.forearm_kg * p.link_m[2] / 2 + p.tip_kg * p.link_m[2];
  const double r = p.counterweight_radius_m;
  // A point `upper` along the upper arm's line and `fore` along the forearm's.
  const auto point = [](const JointVector& q, double upper, double fore) {
    const double radial = upper * std::sin(q[1]) + fore * std::sin(q[2]);
    return Position3{std::cos(q[0]) * radial, std::sin(q[0]) * radial,
                     upper * std::cos(q[1]) - fore * std::cos(q[2])};
  };
  for (int n = 0; n < 40; ++n) {
    const JointVector q = random.pose();
    const JointVector v = random.rate(5);
    JointVector before = q, after = q;
    for (std::size_t i = 0; i < 3; ++i) {
      before[i] -= 1e-6 * v[i];
      after[i] += 1e-6 * v[i];
    }
    const auto energy_of = [&](double kg, double upper, double fore) {
      const double speed = norm(point(after, upper, fore) - point(before, upper, fore)) / 2e-6;
      return 0.5 * kg * speed * speed;
    };
    double expected = 0;
    constexpr int kSlices = 2000;
    for (int k = 0; k < kSlices; ++k) {
      const double along = (k + 0.5) / kSlices;
      expected += energy_of(p.upper_arm_kg / kSlices, along * p.link_m[1], 0);
      expected += energy_of(p.forearm_kg / kSlices, p.link_m[1], along * p.link_m[2]);
    }
    expected += energy_of(p.tip_kg, p.link_m[1], p.link_m[2]);
    expected += energy_of(p.balance * upper_moment / r, -r, 0);
    expected += energy_of(p.balance * fore_moment / r, 0, -r);
    expected += 0.5 * p.turret_kg_m2 * v[0] * v[0];
    for (std::size_t i = 0; i < 3; ++i) {
      const double shaft = v[i] * p.drive_ratio[i];
      expected += 0.5 * p.rotor_kg_m2[i] * shaft * shaft;
    }

    EXPECT_NEAR(sut.kinetic_energy_j(ArmDynamics::pose(q), v), expected, 1e-6 * expected);
  }
}

TEST_P(ArmDynamicsOf, MotionSatisfiesLagrangesEquationNumerically) {
  // d/dt (dT/dq') - dT/dq by differences of the kinetic energy alone, against M q'' + c.
  constexpr double kStep = 1e-4;
  const auto kinetic = [&](const JointVector& q, const JointVector& v) {
    return sut.kinetic_energy_j(ArmDynamics::pose(q), v);
  };
  const auto momentum = [&](const JointVector& q, const JointVector& v, std::size_t i) {
    return (kinetic(q, shifted(v, i, kStep)) - kinetic(q, shifted(v, i, -kStep))) / (2 * kStep);
  };
  for (int n = 0; n < kPoses; ++n) {
    const JointVector q = random.pose();
    const JointVector v = random.rate(5);
    const JointVector a = random.rate(50);
    JointVector q_after{}, q_before{}, v_after{}, v_before{};
    for (std::size_t i = 0; i < 3; ++i) {
      q_after[i] = q[i] + kStep * v[i] + 0.5 * kStep * kStep * a[i];
      q_before[i] = q[i] - kStep * v[i] + 0.5 * kStep * kStep * a[i];
      v_after[i] = v[i] + kStep * a[i];
      v_before[i] = v[i] - kStep * a[i];
    }
    const MassMatrix m = sut.mass_matrix(ArmDynamics::pose(q));
    const JointVector c = sut.coriolis(ArmDynamics::pose(q), v);
    const JointVector actual{m.aa * a[0] + c[0], m.bb * a[1] + m.bc * a[2] + c[1],
                             m.bc * a[1] + m.cc * a[2] + c[2]};
    for (std::size_t i = 0; i < 3; ++i) {
      const double expected =
          (momentum(q_after, v_after, i) - momentum(q_before, v_before, i)) / (2 * kStep) -
          (kinetic(shifted(q, i, kStep), v) - kinetic(shifted(q, i, -kStep), v)) / (2 * kStep);
      EXPECT_NEAR(actual[i], expected, 1e-5);
    }
  }
}

TEST_P(ArmDynamicsOf, SolveUndoesTheMassMatrix) {
  for (int n = 0; n < kPoses; ++n) {
    const MassMatrix m = sut.mass_matrix(ArmDynamics::pose(random.pose()));
    const JointVector a = random.rate(50);

    const JointVector actual =
        ArmDynamics::solve(m, {m.aa * a[0], m.bb * a[1] + m.bc * a[2], m.bc * a[1] + m.cc * a[2]});

    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(actual[i], a[i], 1e-9);
  }
}

TEST_P(ArmDynamicsOf, GravityIsTheSlopeOfTheWeightsHeight) {
  // Height of every mass from the parameters alone, unbalanced, then counterweighted.
  ArmParameters p = GetParam();
  p.balance = 0.3;
  const ArmDynamics partly_balanced(p);
  const double g = p.gravity_m_per_s2;
  const auto potential = [&](const JointVector& q) {
    const double elbow = p.link_m[1] * std::cos(q[1]);
    const double fore = -p.link_m[2] * std::cos(q[2]);
    const double links =
        p.upper_arm_kg * elbow / 2 + p.forearm_kg * (elbow + fore / 2) + p.tip_kg * (elbow + fore);
    return g * links * (1 - p.balance);
  };
  for (int n = 0; n < kPoses; ++n) {
    const JointVector q = random.pose();
    const JointVector actual = partly_balanced.gravity_gradient(ArmDynamics::pose(q));
    for (std::size_t i = 0; i < 3; ++i) {
      const double slope =
          (potential(shifted(q, i, 1e-5)) - potential(shifted(q, i, -1e-5))) / 2e-5;
      EXPECT_NEAR(actual[i], slope, 1e-8);
    }
    EXPECT_NEAR(partly_balanced.potential_energy_j(ArmDynamics::pose(q)), potential(q), 1e-12);
  }
}

class PhantomTipInertia : public testing::TestWithParam<ArmParameters> {};

INSTANTIATE_TEST_SUITE_P(Phantoms, PhantomTipInertia,
                         testing::Values(phantom_vintage_parameters(), premium_1_5_parameters()),
                         model_name);

TEST_P(PhantomTipInertia, IsThatOfTheClass) {
  // Below 75 g in every direction is the brochure's figure for a Premium 1.0 or 1.5.
  const ArmDynamics sut(GetParam());
  const ArmDynamics::Pose home = ArmDynamics::pose(sut.parameters().home_rad);
  const MassMatrix mass = sut.mass_matrix(home);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Force3 unit{};
    unit[axis] = 1;
    const JointVector a = ArmDynamics::solve(mass, sut.torque_of(home, unit));
    const TipJacobian j = sut.jacobian(home);
    const double acceleration = j[axis][0] * a[0] + j[axis][1] * a[1] + j[axis][2] * a[2];

    EXPECT_GT(1 / acceleration, 0.030);
    EXPECT_LT(1 / acceleration, 0.075);
  }
}

}  // namespace
}  // namespace thimble::sim
