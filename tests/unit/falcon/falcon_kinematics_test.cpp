#include "drivers/falcon/falcon_kinematics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "drivers/falcon/find_model.hpp"

namespace thimble::falcon {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

const FalconModel& falcon() { return *find_model("falcon"); }
FalconKinematics kinematics() { return {falcon(), falcon().newton_per_count}; }

double any(std::mt19937& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

// Anywhere in the sphere that the model promises.
Position3 any_tip(std::mt19937& random) {
  const double radius_m = falcon().workspace_radius_m;
  for (;;) {
    const Position3 p{any(random, -radius_m, radius_m), any(random, -radius_m, radius_m),
                      any(random, -radius_m, radius_m)};
    if (norm(p.x, p.y, p.z) <= radius_m) return p;
  }
}

CrankAngles angles_of(Position3 tip) {
  CrankAngles crank_rad{};
  EXPECT_EQ(kinematics().inverse(tip, crank_rad), PoseTrouble::None);
  return crank_rad;
}

ArmPose pose_of(Position3 tip) {
  ArmPose pose;
  EXPECT_EQ(kinematics().forward(angles_of(tip), tip, pose), PoseTrouble::None);
  return pose;
}

void expect_near(Position3 a, Position3 b, double within_m) {
  EXPECT_NEAR(a.x, b.x, within_m);
  EXPECT_NEAR(a.y, b.y, within_m);
  EXPECT_NEAR(a.z, b.z, within_m);
}

TEST(FalconKinematicsDeathTest, ACountThatIsNoForceEndsTheProcess) {
  for (const double bad : {0.0, -0.01, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_DEATH(FalconKinematics(falcon(), bad), "broken invariant: newton_per_count > 0") << bad;
  }
}

TEST(FalconKinematics, CountsAreAnglesAsTheSheetDerivesThem) {
  const CrankAngles home = kinematics().crank_angles({0, 0, 0});
  EXPECT_NEAR(home[0], 35 * kDegree, 1e-8);
  const CrankAngles moved = kinematics().crank_angles({1000, -1000, 9881});
  EXPECT_NEAR(moved[0], (35 + 36.43) * kDegree, 1e-4);
  EXPECT_NEAR(moved[1], (35 - 36.43) * kDegree, 1e-4);
  EXPECT_NEAR(moved[2], (35 + 360) * kDegree, 1e-3);
}

// Worked by hand on the axis, where the legs stand alike: the crank's axis, the knee and the grip
// are a triangle of 60 mm, 125 mm less what the shift across costs, and hypot(25.57 mm, z).
TEST(FalconKinematics, OnItsAxisALegIsATriangle) {
  const double across_m = 0.02309 - 0.025;
  const double rods_m = 2 * 0.01125 + std::sqrt(0.1025 * 0.1025 - across_m * across_m);
  const double out_m = -0.0400 + 0.01443;
  for (const double z_m : {0.090, 0.125, 0.135, 0.150, 0.170}) {
    const double far_m = std::hypot(out_m, z_m);
    const double opening_rad =
        std::acos((0.06 * 0.06 + far_m * far_m - rods_m * rods_m) / (2 * 0.06 * far_m));
    const double expected_rad = std::atan2(z_m, out_m) - opening_rad;
    for (const double crank_rad : angles_of({0, 0, z_m - 0.125})) {
      EXPECT_NEAR(crank_rad, expected_rad, 1e-9) << z_m;
    }
  }
  // Where the encoders say zero the grip is about 135 mm before the device.
  ArmPose pose;
  ASSERT_EQ(kinematics().forward(kinematics().crank_angles({0, 0, 0}), {}, pose),
            PoseTrouble::None);
  expect_near(pose.tip, {0, 0, 0.0097}, 0.0002);
}

// The three equations of falcon_model.hpp, with the other two angles from the sheet's formulas.
TEST(FalconKinematics, InverseFulfilsTheEquationsOfEachLeg) {
  std::mt19937 random(3);
  const FalconModel& m = falcon();
  for (int round = 0; round < 2000; ++round) {
    const Position3 tip = any_tip(random);
    const CrankAngles crank_rad = angles_of(tip);
    for (std::size_t leg = 0; leg < 3; ++leg) {
      const double phi = m.leg_azimuth_rad[leg];
      const double u = tip.x * std::cos(phi) + tip.y * std::sin(phi) - m.base_radius_m;
      const double v = -tip.x * std::sin(phi) + tip.y * std::cos(phi) - m.base_shift_m;
      const double w = tip.z + m.origin_m[2];
      const double theta1 = crank_rad[leg];
      const double theta3 = std::acos((v + m.grip_shift_m) / m.rods_m);
      const double rods_m = m.knee_m + m.ankle_m + m.rods_m * std::sin(theta3);
      const double theta2 =
          std::acos((u - m.crank_m * std::cos(theta1) + m.grip_radius_m) / rods_m);
      ASSERT_NEAR(m.crank_m * std::sin(theta1) + rods_m * std::sin(theta2), w, 1e-9);
      ASSERT_GT(std::sin(theta2 - theta1), 0) << "the knee is bent outwards";
    }
  }
}

TEST(FalconKinematics, ForwardFindsFromAnywhereWhatInverseSays) {
  std::mt19937 random(4);
  const FalconKinematics sut = kinematics();
  for (int round = 0; round < 5000; ++round) {
    const Position3 tip = any_tip(random);
    ArmPose pose;
    ASSERT_EQ(sut.forward(angles_of(tip), any_tip(random), pose), PoseTrouble::None) << round;
    ASSERT_LT(norm(pose.tip - tip), 1e-8) << round;
  }
}

TEST(FalconKinematics, TheTopLegLeansUpAndTheGripFollowsTheCranks) {
  const ArmPose middle = pose_of({});
  // More of all cranks moves the grip towards the person, and nowhere else.
  const auto& j = middle.jacobian_m_per_rad.row;
  EXPECT_NEAR(j[0][0] + j[0][1] + j[0][2], 0, 1e-9);
  EXPECT_NEAR(j[1][0] + j[1][1] + j[1][2], 0, 1e-9);
  EXPECT_NEAR(j[2][0] + j[2][1] + j[2][2], 0.0757, 0.0002);
  // A grip that is up has its top leg folded out and the others stretched in.
  const CrankAngles up = angles_of({0, 0.03, 0});
  EXPECT_LT(up[0], middle.crank_rad[0]);
  EXPECT_GT(up[2], middle.crank_rad[2]);
  const CrankAngles right = angles_of({0.03, 0, 0});
  EXPECT_LT(right[1], middle.crank_rad[1]);
}

TEST(FalconKinematics, JacobianIsTheDerivativeOfForward) {
  std::mt19937 random(5);
  const FalconKinematics sut = kinematics();
  constexpr double kStep_rad = 1e-5;
  for (int round = 0; round < 500; ++round) {
    const ArmPose pose = pose_of(any_tip(random));
    for (std::size_t leg = 0; leg < 3; ++leg) {
      CrankAngles more = pose.crank_rad;
      CrankAngles less = pose.crank_rad;
      more[leg] += kStep_rad;
      less[leg] -= kStep_rad;
      ArmPose ahead, behind;
      ASSERT_EQ(sut.forward(more, pose.tip, ahead), PoseTrouble::None);
      ASSERT_EQ(sut.forward(less, pose.tip, behind), PoseTrouble::None);
      const Displacement3 moved = ahead.tip - behind.tip;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        ASSERT_NEAR(pose.jacobian_m_per_rad.row[axis][leg], moved[axis] / (2 * kStep_rad), 1e-4);
      }
    }
  }
}

// One count of torque about a crank, from the definition of the scale: what all three motors hold
// at the origin along z, when told one count each, is newton_per_count.
double torque_per_count_newton_m(const FalconModel& model) {
  double dz_m_per_rad = 0;
  const ArmPose middle = pose_of({});
  for (const double column : middle.jacobian_m_per_rad.row[2]) dz_m_per_rad += column;
  return model.newton_per_count * dz_m_per_rad / 3;
}

TEST(FalconKinematics, CommandsDoTheWorkThatTheForceDoes) {
  std::mt19937 random(6);
  const double newton_m_per_count = torque_per_count_newton_m(falcon());
  for (int round = 0; round < 1000; ++round) {
    const ArmPose pose = pose_of(any_tip(random));
    const Force3 force{any(random, -8, 8), any(random, -8, 8), any(random, -8, 8)};
    CrankAngles rate{any(random, -1, 1), any(random, -1, 1), any(random, -1, 1)};
    double motor_watt = 0;
    double tip_watt = 0;
    for (std::size_t leg = 0; leg < 3; ++leg) {
      const auto& row = pose.command_per_force.row[leg];
      const double counts = row[0] * force.x + row[1] * force.y + row[2] * force.z;
      motor_watt += falcon().motor_direction[leg] * counts * newton_m_per_count * rate[leg];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        tip_watt += force[axis] * pose.jacobian_m_per_rad.row[axis][leg] * rate[leg];
      }
    }
    ASSERT_NEAR(motor_watt, tip_watt, 1e-9 * (1 + std::abs(tip_watt)));
  }
}

// The vendor's samples: -25 along z is 1311, 1453, 1526 and -12.5 is 661, 731, 766. By the scale of
// the table, which takes the unit for a newton, their mean and their sign are ours.
TEST(FalconKinematics, TheVendorsSamplesAreForcesIntoTheDevice) {
  const Matrix3 command_per_force = pose_of({}).command_per_force;
  const auto& rows = command_per_force.row;
  double sum = 0;
  for (std::size_t motor = 0; motor < 3; ++motor) sum += rows[motor][2] * -25;
  EXPECT_NEAR(sum / 3, (1311 + 1453 + 1526) / 3.0, 5);
  EXPECT_NEAR(sum / 3 / 2, (661 + 731 + 766) / 3.0, 10);
  for (std::size_t motor = 0; motor < 3; ++motor) EXPECT_LT(rows[motor][2], 0);
}

TEST(FalconKinematics, AScaleOfHalfTheNewtonsTakesTwiceTheCounts) {
  const FalconKinematics half(falcon(), falcon().newton_per_count / 2);
  ArmPose weak, strong;
  ASSERT_EQ(half.forward(angles_of({}), {}, weak), PoseTrouble::None);
  ASSERT_EQ(kinematics().forward(angles_of({}), {}, strong), PoseTrouble::None);
  EXPECT_NEAR(weak.command_per_force.row[1][2], 2 * strong.command_per_force.row[1][2], 1e-9);
}

// What the clamp of commands can rely on: nowhere in the workspace does a newton cost more than
// four times the counts of the worst axis in its middle.
TEST(FalconKinematics, CommandsStayModestInTheWholeWorkspace) {
  std::mt19937 random(8);
  const auto largest = [](const Matrix3& m) {
    double most = 0;
    for (const auto& row : m.row) {
      for (const double value : row) most = std::max(most, std::abs(value));
    }
    return most;
  };
  const double in_the_middle = largest(pose_of({}).command_per_force);
  for (int round = 0; round < 2000; ++round) {
    EXPECT_LT(largest(pose_of(any_tip(random)).command_per_force), 4 * in_the_middle);
  }
}

TEST(FalconKinematics, RefusesByNameWhatItCannotReach) {
  const FalconKinematics sut = kinematics();
  CrankAngles out{1, 2, 3};
  const double infinity = std::numeric_limits<double>::infinity();
  for (const Position3 tip : {Position3{0, 0, 0.07}, Position3{0.15, 0, 0}, Position3{0, 0, 5},
                              Position3{infinity, 0, 0}, Position3{0, std::nan(""), 0}}) {
    EXPECT_EQ(sut.inverse(tip, out), PoseTrouble::OutOfReach) << tip.x << ' ' << tip.z;
  }
  EXPECT_EQ(out, (CrankAngles{1, 2, 3})) << "untouched";
  // Behind the stops: the cranks would have to point backwards.
  EXPECT_EQ(sut.inverse({0, 0, -0.065}, out), PoseTrouble::OutOfReach);
  EXPECT_EQ(to_string(PoseTrouble::OutOfReach), "unreachable");
}

TEST(FalconKinematics, RefusesByNameALegThatIsStretched) {
  CrankAngles out{};
  EXPECT_EQ(kinematics().inverse({0, 0, 0.05808}, out), PoseTrouble::Singular);
  EXPECT_EQ(to_string(PoseTrouble::Singular), "singular");
}

// A person pulls the grip fully out to home the arm: there it is known, and a force is bounded.
TEST(FalconKinematics, AStretchedArmHasAPose) {
  const FalconKinematics sut = kinematics();
  ArmPose pose;
  for (const double degrees : {80.0, 85.0, 90.0, 94.0}) {
    const double crank_rad = degrees * kDegree;
    ASSERT_EQ(sut.forward({crank_rad, crank_rad, crank_rad}, pose.tip, pose), PoseTrouble::None)
        << degrees;
    EXPECT_NEAR(pose.tip.x, 0, 1e-6);
    EXPECT_NEAR(pose.tip.z, 0.055, 0.006);
    for (const auto& row : pose.command_per_force.row) {
      for (const double value : row) EXPECT_LT(std::abs(value), 200);
    }
  }
}

TEST(FalconKinematics, LegsThatNoGripJoinsAreNoPose) {
  const FalconKinematics sut = kinematics();
  ArmPose pose;
  const CrankAngles apart{-0.7, 1.6, 1.6};
  EXPECT_NE(sut.forward({2.6, 2.6, -2}, {}, pose), PoseTrouble::None);
  EXPECT_NE(sut.forward({std::nan(""), 0, 0}, {}, pose), PoseTrouble::None);
  EXPECT_NE(sut.forward(angles_of({}), {std::nan(""), 0, 0}, pose), PoseTrouble::None);
  EXPECT_EQ(pose, ArmPose{}) << "untouched";
  EXPECT_FALSE(sut.is_beyond_stops(apart, 0));
}

// Encoders may say anything: there is a pose that fits them, or none, and all its numbers are
// finite.
TEST(FalconKinematics, AnyCountsGiveAFinitePoseOrTrouble) {
  std::mt19937 random(9);
  const FalconKinematics sut = kinematics();
  int found = 0;
  for (int round = 0; round < 5000; ++round) {
    std::array<std::int16_t, 3> counts{};
    const int limit = round % 2 == 0 ? 32767 : 2500;
    for (std::int16_t& value : counts) {
      value = static_cast<std::int16_t>(std::uniform_int_distribution<int>(-limit, limit)(random));
    }
    ArmPose pose;
    if (sut.forward(sut.crank_angles(counts), {}, pose) != PoseTrouble::None) continue;
    ++found;
    ASSERT_TRUE(is_finite(pose.tip));
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& row = pose.command_per_force.row[i];
      ASSERT_TRUE(is_finite(row[0], row[1], row[2]));
    }
  }
  EXPECT_GT(found, 100);
}

TEST(FalconKinematics, StopsHaveSlackOnBothSides) {
  const FalconKinematics sut = kinematics();
  const CrankAngles inside = angles_of({});
  EXPECT_FALSE(sut.is_beyond_stops(inside, 0));
  for (std::size_t leg = 0; leg < 3; ++leg) {
    for (const double stop_rad :
         {falcon().crank_min_rad[leg] - 0.1, falcon().crank_max_rad[leg] + 0.1}) {
      CrankAngles at_stop = inside;
      at_stop[leg] = stop_rad;
      EXPECT_TRUE(sut.is_beyond_stops(at_stop, 0.05));
      EXPECT_FALSE(sut.is_beyond_stops(at_stop, 0.15));
    }
  }
  EXPECT_TRUE(sut.is_beyond_stops({std::nan(""), 0.5, 0.5}, 1));
}

}  // namespace
}  // namespace thimble::falcon
