#include "drivers/phantom/phantom_kinematics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "drivers/phantom/find_model.hpp"

namespace thimble::phantom {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kRounds = 2000;

// Properties that hold for every model, at random places of its workspace.
class PhantomKinematics : public testing::TestWithParam<const PhantomModel*> {
 protected:
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  Position3 place_in_workspace() {
    const double radius_m = model_.workspace_radius_m;
    while (true) {
      const Displacement3 d{uniform(-radius_m, radius_m), uniform(-radius_m, radius_m),
                            uniform(-radius_m, radius_m)};
      if (norm(d) <= radius_m) return Position3{} + d;
    }
  }
  Force3 any_force() { return {uniform(-5, 5), uniform(-5, 5), uniform(-5, 5)}; }

  const PhantomModel& model_{*GetParam()};
  std::mt19937 random_{20};
};

std::vector<const PhantomModel*> all_models() {
  std::vector<const PhantomModel*> models;
  for (const PhantomModel& model : kPhantomModels) models.push_back(&model);
  return models;
}

INSTANTIATE_TEST_SUITE_P(AllModels, PhantomKinematics, testing::ValuesIn(all_models()),
                         [](const auto& parameter) {
                           std::string name(parameter.param->name);
                           std::replace_if(
                               name.begin(), name.end(),
                               [](char c) { return c == '-' || c == '.'; }, '_');
                           return name;
                         });

template <class Vector>
std::array<double, 3> times(const Matrix3& m, const Vector& v) {
  std::array<double, 3> product{};
  for (std::size_t i = 0; i < 3; ++i) {
    product[i] = m.row[i][0] * v[0] + m.row[i][1] * v[1] + m.row[i][2] * v[2];
  }
  return product;
}

TEST_P(PhantomKinematics, InverseThenForwardComesBackToThePlace) {
  for (int round = 0; round < kRounds; ++round) {
    const Position3 place = place_in_workspace();
    const auto angles = inverse(model_, place);
    ASSERT_TRUE(angles) << place.x << ' ' << place.y << ' ' << place.z;
    EXPECT_FALSE(is_singular(model_, *angles));
    EXPECT_LT(norm(pose_at(model_, *angles).tip - place), 1e-12);
  }
}

TEST_P(PhantomKinematics, ForwardThenInverseComesBackToTheAngles) {
  for (int round = 0; round < kRounds; ++round) {
    const BodyAngles angles{uniform(-1.2, 1.2), uniform(0.1, 1.4), uniform(0.1, 1.5)};
    const auto back = inverse(model_, pose_at(model_, angles).tip);
    ASSERT_TRUE(back);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR((*back)[i], angles[i], 1e-9);
  }
}

TEST_P(PhantomKinematics, JacobianAgreesWithNumericalDifferentiation) {
  constexpr double kStep_rad = 1e-6;
  for (int round = 0; round < kRounds; ++round) {
    const BodyAngles angles{uniform(-3, 3), uniform(-3, 3), uniform(-3, 3)};
    const Matrix3 jacobian = pose_at(model_, angles).jacobian_m_per_rad;
    for (std::size_t joint = 0; joint < 3; ++joint) {
      BodyAngles before = angles, after = angles;
      before[joint] -= kStep_rad;
      after[joint] += kStep_rad;
      const Displacement3 moved = pose_at(model_, after).tip - pose_at(model_, before).tip;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        ASSERT_NEAR(jacobian.row[axis][joint], moved[axis] / (2 * kStep_rad), 1e-9);
      }
    }
  }
}

// What the motors put in comes out at the tip: sum of Kt·I·(motor speed) = F · v, with the
// motor speed as the encoder sees it. The tip's velocity is differentiated, not taken from J.
TEST_P(PhantomKinematics, MotorPowerIsTipPower) {
  constexpr double kStep_s = 1e-6;
  for (int round = 0; round < kRounds; ++round) {
    const BodyAngles angles = *inverse(model_, place_in_workspace());
    const BodyAngles rate{uniform(-4, 4), uniform(-4, 4), uniform(-4, 4)};
    const Force3 force = any_force();
    const auto current_a = times(pose_at(model_, angles).motor_current_per_force, force);
    BodyAngles before = angles, after = angles;
    double motor_power_w = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      before[i] -= rate[i] * kStep_s;
      after[i] += rate[i] * kStep_s;
      const double motor_speed_rad_per_s = model_.motor_direction[i] * rate[i] *
                                           model_.drum_diameter_m[i] / model_.capstan_diameter_m[i];
      motor_power_w +=
          model_.torque_constant_newton_m_per_a[i] * current_a[i] * motor_speed_rad_per_s;
    }
    const Displacement3 moved = pose_at(model_, after).tip - pose_at(model_, before).tip;
    ASSERT_NEAR(dot(force, moved) / (2 * kStep_s), motor_power_w, 1e-6);
  }
}

// The sheet writes the torques out; the driver transposes its Jacobian. Both must agree.
TEST_P(PhantomKinematics, TorquesAreThoseOfTheSheet) {
  for (int round = 0; round < kRounds; ++round) {
    const BodyAngles angles{uniform(-3, 3), uniform(-3, 3), uniform(-3, 3)};
    const Force3 force = any_force();
    const double fx = force.z, fy = force.x, fz = force.y;  // device frame
    const double a = angles[0], b = angles[1], c = angles[2];
    const double lb = model_.link_m[1], lc = model_.link_m[2];
    const double r = lb * std::sin(b) + lc * std::sin(c);
    const std::array<double, 3> torque_newton_m{
        -std::sin(a) * r * fx + std::cos(a) * r * fy,
        lb * (std::cos(a) * std::cos(b) * fx + std::sin(a) * std::cos(b) * fy - std::sin(b) * fz),
        lc * (std::cos(a) * std::cos(c) * fx + std::sin(a) * std::cos(c) * fy + std::sin(c) * fz)};
    const auto current_a = times(pose_at(model_, angles).motor_current_per_force, force);
    for (std::size_t i = 0; i < 3; ++i) {
      const double expected_a = model_.motor_direction[i] * torque_newton_m[i] *
                                model_.capstan_diameter_m[i] / model_.drum_diameter_m[i] /
                                model_.torque_constant_newton_m_per_a[i];
      ASSERT_NEAR(current_a[i], expected_a, 1e-12);
    }
  }
}

TEST_P(PhantomKinematics, LeftAndRightAreMirrorImages) {
  for (int round = 0; round < kRounds; ++round) {
    const BodyAngles right{uniform(-1.5, 1.5), uniform(-1, 2), uniform(-1, 2)};
    const ArmPose pose = pose_at(model_, right);
    const ArmPose mirrored = pose_at(model_, {-right[0], right[1], right[2]});
    EXPECT_DOUBLE_EQ(mirrored.tip.x, -pose.tip.x);
    EXPECT_DOUBLE_EQ(mirrored.tip.y, pose.tip.y);
    EXPECT_DOUBLE_EQ(mirrored.tip.z, pose.tip.z);
    const Force3 force = any_force();
    const auto current_a = times(pose.motor_current_per_force, force);
    const auto mirrored_a =
        times(mirrored.motor_current_per_force, Force3{-force.x, force.y, force.z});
    EXPECT_DOUBLE_EQ(mirrored_a[0], -current_a[0]);
    EXPECT_DOUBLE_EQ(mirrored_a[1], current_a[1]);
    EXPECT_DOUBLE_EQ(mirrored_a[2], current_a[2]);
  }
}

TEST_P(PhantomKinematics, ZeroCountsAreTheHomePose) {
  EXPECT_EQ(body_angles(model_, {}), model_.home_angle_rad);
}

TEST_P(PhantomKinematics, OneTurnOfAMotorTurnsItsBodyByTheDrive) {
  for (std::size_t i = 0; i < 3; ++i) {
    std::array<EncoderCounts, 3> counts{};
    counts[i].value = static_cast<std::int32_t>(model_.counts_per_motor_rev[i]);
    const double turned_rad = body_angles(model_, counts)[i] - model_.home_angle_rad[i];
    EXPECT_NEAR(turned_rad,
                model_.motor_direction[i] * 2 * kPi * model_.capstan_diameter_m[i] /
                    model_.drum_diameter_m[i],
                1e-12);
  }
}

// Counted round by round beside it: a turning gimbal never jumps but where -π meets π.
TEST_P(PhantomKinematics, GimbalAnglesFollowTheCountersThroughTurnsAndWraps) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto per_rev = static_cast<int>(model_.gimbal_counts_per_rev[axis]);
    for (int turned = -100'000; turned <= 100'000; turned += 7) {
      std::array<std::int16_t, 3> counts{};
      counts[axis] = static_cast<std::int16_t>(static_cast<std::uint16_t>(turned & 0xffff));
      const std::array<double, 3> angle_rad = gimbal_angle_rad(model_, counts);
      for (std::size_t other = 0; other < 3; ++other) {
        if (other != axis || per_rev == 0) {
          ASSERT_EQ(angle_rad[other], 0);
          continue;
        }
        ASSERT_LE(std::abs(angle_rad[axis]), kPi + 1e-12);
        const double turned_rad = 2 * kPi * turned / per_rev;
        ASSERT_NEAR(std::cos(angle_rad[axis]), std::cos(turned_rad), 1e-9);
        ASSERT_NEAR(std::sin(angle_rad[axis]), std::sin(turned_rad), 1e-9);
      }
    }
  }
}

TEST_P(PhantomKinematics, SingularPosesAreReportedAndStayFinite) {
  const BodyAngles stretched{0.3, 1.0, kPi - 1.0};
  const BodyAngles folded{0.3, 1.0, -1.0};
  // Elbow behind the waist by as much as the forearm brings forward.
  const double back_m = 0.5 * std::min(model_.link_m[1], model_.link_m[2]);
  const BodyAngles over_the_waist{0.3, -std::asin(back_m / model_.link_m[1]),
                                  std::asin(back_m / model_.link_m[2])};
  for (const BodyAngles& angles : {stretched, folded, over_the_waist, BodyAngles{0, 0, 0}}) {
    const ArmPose pose = pose_at(model_, angles);
    EXPECT_TRUE(is_finite(pose.tip));
    for (const auto& row : pose.motor_current_per_force.row) {
      EXPECT_TRUE(is_finite(row[0], row[1], row[2]));
    }
  }
  EXPECT_TRUE(is_singular(model_, stretched));
  EXPECT_TRUE(is_singular(model_, folded));
  EXPECT_TRUE(is_singular(model_, over_the_waist));
  EXPECT_FALSE(is_singular(model_, model_.home_angle_rad));
  EXPECT_TRUE(is_singular(model_, {0, std::nan(""), 0}));
}

TEST_P(PhantomKinematics, OutOfReachHasNoAngles) {
  const double reach_m = model_.link_m[1] + model_.link_m[2];
  EXPECT_FALSE(inverse(model_, {reach_m + model_.origin_m[0], 0, 0}));
  EXPECT_FALSE(inverse(model_, {0, std::nan(""), 0}));
  const Position3 shoulder{0, model_.link_m[0] - model_.origin_m[2], -model_.origin_m[0]};
  EXPECT_FALSE(inverse(model_, shoulder));
}

// An arm that reaches beyond its stops loses its reference there: the workspace must not.
// There a force would ask for currents without bound, and the waist for no angle in particular.
TEST_P(PhantomKinematics, PlacesOnTheAxisOfTheWaistHaveNoAngles) {
  const double shortest_m = std::abs(model_.link_m[1] - model_.link_m[2]);
  const double longest_m = model_.link_m[1] + model_.link_m[2];
  for (int round = 0; round < kRounds; ++round) {
    const double above_shoulder_m = uniform(shortest_m + 0.001, longest_m - 0.001);
    const Position3 tip{-model_.origin_m[1],
                        above_shoulder_m - model_.origin_m[2] + model_.link_m[0],
                        -model_.origin_m[0]};
    ASSERT_FALSE(inverse(model_, tip).has_value()) << above_shoulder_m;
  }
}

TEST_P(PhantomKinematics, TheWorkspaceLiesWithinTheStops) {
  for (int round = 0; round < kRounds; ++round) {
    const auto angles = inverse(model_, place_in_workspace());
    ASSERT_TRUE(angles);
    for (std::size_t i = 0; i < 3; ++i) {
      ASSERT_GE((*angles)[i], model_.joint_min_rad[i]) << i;
      ASSERT_LE((*angles)[i], model_.joint_max_rad[i]) << i;
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_GE(model_.home_angle_rad[i], model_.joint_min_rad[i]);
    EXPECT_LE(model_.home_angle_rad[i], model_.joint_max_rad[i]);
  }
}

// The limiter clamps each motor's current; below that the promised force must fit, or it would be
// felt too weak without a word.
TEST_P(PhantomKinematics, ThePeakForceAtTheOriginFitsThePeakCurrents) {
  const Matrix3 currents = pose_at(model_, *inverse(model_, {})).motor_current_per_force;
  for (int round = 0; round < kRounds; ++round) {
    const Force3 any = any_force();
    const Force3 force = (model_.peak_force_newton / norm(any)) * any;
    const auto current_a = times(currents, force);
    for (std::size_t i = 0; i < 3; ++i) ASSERT_LE(std::abs(current_a[i]), model_.peak_current_a[i]);
  }
}

// What phantom_models.toml claims of the home pose.
TEST(PhantomVintage, ReachesACubeOf128MillimetresWithoutComingNearASingularPose) {
  const PhantomModel& model = *find_model("phantom-vintage");
  constexpr int kSteps = 17;
  const auto place = [](int step) { return -0.064 + 0.128 * step / (kSteps - 1); };
  double least_sine = 1, least_reach_m = 1;
  for (int index = 0; index < kSteps * kSteps * kSteps; ++index) {
    const Position3 tip{place(index % kSteps), place(index / kSteps % kSteps),
                        place(index / kSteps / kSteps)};
    const auto angles = inverse(model, tip);
    ASSERT_TRUE(angles) << index;
    least_sine = std::min(least_sine, std::sin((*angles)[1] + (*angles)[2]));
    least_reach_m = std::min(least_reach_m, std::hypot(tip.z + model.origin_m[0], tip.x));
  }
  EXPECT_GT(least_sine, 0.62);
  EXPECT_GT(least_reach_m, 0.089);
}

TEST(PhantomVintage, RestsAtTheOriginInItsHomePose) {
  const PhantomModel& model = *find_model("phantom-vintage");
  EXPECT_LT(norm(pose_at(model, model.home_angle_rad).tip - Position3{}), 1e-8);
}

// From the sheet's axes: positive a swings the tip to the right, more b lowers and advances
// it, more c raises it.
TEST(PhantomVintage, AxesPointRightUpAndTowardsThePerson) {
  const PhantomModel& model = *find_model("phantom-vintage");
  const BodyAngles home = model.home_angle_rad;
  EXPECT_GT(pose_at(model, {0.1, home[1], home[2]}).tip.x, 0.01);
  EXPECT_GT(pose_at(model, {0, home[1], home[2] + 0.1}).tip.y, 0.005);
  EXPECT_GT(pose_at(model, {0, home[1] + 0.1, home[2]}).tip.z, 0.005);
  EXPECT_LT(pose_at(model, {0, home[1] + 0.1, home[2]}).tip.y, -0.005);
}

// That this rebuilt arm is a 1.5: its links reach every corner of the 381 x 267 x 191 mm quoted for
// one (sheet 2.8, a brochure's figure), from 190 mm before the waist, with its elbow bent.
TEST(Premium15, ItsLinksReachTheCornersOfTheQuotedWorkspace) {
  const PhantomModel& model = *find_model("premium-1.5");
  const Displacement3 middle{0, 0, 0.190 - model.origin_m[0]};
  for (int corner = 0; corner < 8; ++corner) {
    const auto side = [corner](int axis, double length_m) {
      return ((corner >> axis) & 1) != 0 ? length_m / 2 : -length_m / 2;
    };
    const Position3 tip = Position3{side(0, 0.381), side(1, 0.267), side(2, 0.191)} + middle;
    const auto angles = inverse(model, tip);
    ASSERT_TRUE(angles) << corner;
    EXPECT_GT(std::sin((*angles)[1] + (*angles)[2]), 0.4) << corner;
    EXPECT_LT(norm(pose_at(model, *angles).tip - tip), 1e-12);
  }
}

// The sheet's own formulas for this arm measure q2 from level and q3 from hanging down.
TEST(Premium15, AgreesWithTheFormulasOfItsOwnSheet) {
  const PhantomModel& model = *find_model("premium-1.5");
  std::mt19937 random{21};
  std::uniform_real_distribution<double> angle(-1.5, 1.5);
  for (int round = 0; round < kRounds; ++round) {
    const double q1 = angle(random), q2 = angle(random), q3 = angle(random);
    const double reach_m = 0.20955 * std::cos(q2) + 0.169545 * std::sin(q3);
    const double height_m = 0.20955 * std::sin(q2) - 0.169545 * std::cos(q3);
    const Position3 tip = pose_at(model, {q1, kPi / 2 - q2, q3}).tip;
    ASSERT_NEAR(tip.z + model.origin_m[0], std::cos(q1) * reach_m, 1e-12);
    ASSERT_NEAR(tip.x + model.origin_m[1], std::sin(q1) * reach_m, 1e-12);
    ASSERT_NEAR(tip.y, height_m, 1e-12) << "the origin is level with the shoulder";
  }
}

}  // namespace
}  // namespace thimble::phantom
