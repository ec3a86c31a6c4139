#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/campaign/good_course.hpp"

// The invariant is seen to hold on a good course and to break on a planted breach.
namespace thimble::campaign {
namespace {

using testing::HasSubstr;

TEST(ArmForce, HoldsOnAGoodCourse) { EXPECT_EQ(GoodCourse(&make_arm_force).broken(), ""); }

TEST(ArmForce, SeesCurrentsAtTheWireAndInTheMotors) {
  GoodCourse wire(&make_arm_force);
  wire.run(1, [](Observation& now) { now.wire.largest_a[2] = 3.01; });
  EXPECT_THAT(wire.broken(), HasSubstr("wire"));
  GoodCourse motor(&make_arm_force);
  motor.run(1, [](Observation& now) { now.truth.motor_current_a[1] = -3.01; });
  EXPECT_THAT(motor.broken(), HasSubstr("motor"));
}

TEST(ArmForce, SeesWhatIsNotFiniteAtTheArm) {
  constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
  for (const auto spoil : {+[](Observation& now) { now.truth.motor_force.y = kNotANumber; },
                           +[](Observation& now) { now.truth.tip.z = kNotANumber; }}) {
    GoodCourse course(&make_arm_force);
    course.run(1, spoil);
    EXPECT_THAT(course.broken(), HasSubstr("at the arm is finite"));
  }
}

TEST(ArmForce, SeesANormThatOnlyTheArmShows) {
  GoodCourse course(&make_arm_force);
  double newton = 1;
  course.run(100, [&](Observation& now) { now.truth.motor_force = {0, newton += 0.1, 0}; });
  EXPECT_THAT(course.broken(), HasSubstr("norm of the force at the arm"));
}

// A force turned by the way that a tip went while it was on the bus.
TEST(ArmForce, AllowsATipThatIsShovedMoreThanOneThatRests) {
  for (const double speed_m_per_s : {0.0, 1.0}) {
    GoodCourse course(&make_arm_force);
    double newton = 1;
    course.run(43, [&](Observation& now) {
      now.truth.tip_velocity = {0, speed_m_per_s, 0};
      now.truth.motor_force = {0, newton += 0.1, 0};
    });
    EXPECT_EQ(course.broken().empty(), speed_m_per_s > 0) << course.broken();
    course.run(3, [&](Observation& now) { now.truth.motor_force = {0, newton += 0.1, 0}; });
    EXPECT_THAT(course.broken(), HasSubstr("norm of the force at the arm"));
  }
}

TEST(ArmForce, ExcusesAnArmThatWasHeldAwayFromHomeAtItsReferenceUntilTheNext) {
  GoodCourse course(&make_arm_force);
  const auto find_reference = [&](double away_m) {
    course.run(1, [](Observation& now) {
      now.servo.frame.calibration = CalibrationState::NeedsUser;
      now.servo.frame.state = OperatingState::Inactive;
    });
    course.run(1, [&](Observation& now) {
      now.servo.frame.calibration = CalibrationState::Ok;
      now.truth.tip = {0, 0, away_m};
    });
  };
  double newton = 1;
  const auto too_much = [&](Observation& now) {
    now.truth.motor_force = {0, std::min(newton += 0.1, 5.5), 0};
  };
  find_reference(0.03);
  course.run(100, too_much);
  EXPECT_EQ(course.broken(), "");
  find_reference(0.0005);
  newton = 1;
  course.run(100, too_much);
  EXPECT_THAT(course.broken(), HasSubstr("norm of the force at the arm"));
}

// Near an arm's stretched and folded poses a millimetre is another force.
TEST(ArmForce, ExcusesTheNormOfATipThatIsOutOfTheWorkSpaceButNoCurrent) {
  GoodCourse course(&make_arm_force);
  double newton = 1;
  const auto outside = [&](Observation& now) {
    now.truth.tip = {0, 0.07, -0.07};
    now.truth.motor_force = {0, newton = std::min(newton + 0.1, 5.5), 0};
  };
  course.run(100, outside);
  EXPECT_EQ(course.broken(), "");
  course.run(1, [&](Observation& now) {
    outside(now);
    now.truth.motor_current_a[0] = 3.01;
  });
  EXPECT_THAT(course.broken(), HasSubstr("current of a motor"));
}

TEST(ArmForce, SeesARiseThatOnlyTheArmShows) {
  GoodCourse course(&make_arm_force, 100);
  course.run(1, [](Observation& now) { now.truth.motor_force = {4.9, 0, 0}; });
  EXPECT_THAT(course.broken(), HasSubstr("rise of the force at the arm"));
}

TEST(ArmForce, ExcusesASpoiltReportUntilTheNextOneActs) {
  GoodCourse course(&make_arm_force);
  const auto wrong = [](Observation& now) { now.truth.motor_current_a[0] = 20; };
  course.run(1, [&](Observation& now) { ++now.spoilt_out; });
  course.run(4, wrong);
  EXPECT_EQ(course.broken(), "");
  course.run(10, wrong);
  EXPECT_THAT(course.broken(), HasSubstr("motor"));
}

TEST(ArmForce, ExcusesReportsThatAreLateUntilTheNextOneActs) {
  GoodCourse course(&make_arm_force, 100);
  const auto late = [](Observation& now) {
    now.late_out_at = now.servo.frame.now;
    now.truth.motor_force = {4.9, 0, 0};
  };
  course.run(10, late);
  EXPECT_EQ(course.broken(), "");
  course.run(30);
  EXPECT_EQ(course.broken(), "") << "a force that falls";
  course.run(1, [](Observation& now) { now.truth.motor_force = {4.9, 0, 0}; });
  EXPECT_THAT(course.broken(), HasSubstr("rise of the force at the arm"));
}

}  // namespace
}  // namespace thimble::campaign
