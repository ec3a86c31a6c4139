#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/campaign/good_course.hpp"

// The invariant is seen to hold on a good course and to break on a planted breach.
namespace thimble::campaign {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

// A servo that asks for nothing, and an arm that still pulls.
void haunted(Observation& now) { now.servo.frame.force = {}; }
void quiet(Observation& now) {
  now.servo.frame.force = {};
  now.truth.motor_current_a = {};
}
void runs_away(Observation& now) { now.truth.tip_velocity = {0, 1.4, 1.4}; }
void undisturbed(Observation& now) { now.cable_ok_since = {}; }

TEST(ArmTruth, HoldsOnAGoodCourse) { EXPECT_EQ(GoodCourse(&make_arm_truth).broken(), ""); }

TEST(ArmTruth, SeesMotorsThatPullThoughNothingIsAskedOfThem) {
  GoodCourse course(&make_arm_truth);
  course.run(10, &haunted);
  EXPECT_EQ(course.broken(), "") << "so long is a report under way";
  course.run(1, &haunted);
  EXPECT_THAT(course.broken(), HasSubstr("nothing is asked"));
}

TEST(ArmTruth, HoldsForMotorsThatFallSilentInTime) {
  GoodCourse course(&make_arm_truth);
  course.run(10, &haunted);
  course.run(100, &quiet);
  EXPECT_EQ(course.broken(), "");
}

TEST(ArmTruth, ExcusesAnArmThatHearsNothingOrHearsItWrong) {
  for (const auto disturb : {+[](Observation& now) { now.wire.last_report = {}; },
                             +[](Observation& now) { ++now.spoilt_out; },
                             +[](Observation& now) { now.late_out_at = now.servo.frame.now; }}) {
    GoodCourse course(&make_arm_truth);
    course.run(30, [&](Observation& now) {
      haunted(now);
      disturb(now);
    });
    EXPECT_EQ(course.broken(), "");
    course.run(11, &haunted);
    EXPECT_THAT(course.broken(), HasSubstr("nothing is asked")) << "but no longer than that";
  }
}

TEST(ArmTruth, SeesATipThatRunsAwayThoughTheServoSaysItRests) {
  GoodCourse course(&make_arm_truth);
  course.run(30, &undisturbed);
  course.run(22, &runs_away);
  EXPECT_EQ(course.broken(), "") << "a filter's time is granted";
  course.run(1, &runs_away);
  EXPECT_THAT(course.broken(), HasSubstr("runs away"));
}

TEST(ArmTruth, HoldsForATipThatRunsAwayAndIsNotDriven) {
  GoodCourse course(&make_arm_truth);
  course.run(20, &runs_away);
  course.run(100, [](Observation& now) {
    runs_away(now);
    quiet(now);
    now.servo.frame.state = OperatingState::Fault;
  });
  EXPECT_EQ(course.broken(), "");
}

TEST(ArmTruth, ExcusesASpeedThatNobodyCouldReadOffTheCable) {
  GoodCourse course(&make_arm_truth);
  course.run(100, [](Observation& now) {
    runs_away(now);
    now.cable_ok_since = now.servo.frame.now;
  });
  EXPECT_EQ(course.broken(), "");
}

TEST(ArmTruth, ExcusesAnArmThatFoundItsReferenceAwayFromHome) {
  GoodCourse course(&make_arm_truth);
  course.run(1, [](Observation& now) {
    now.servo.frame.calibration = CalibrationState::NeedsUser;
    now.servo.frame.state = OperatingState::Inactive;
  });
  const auto at_home = [](Observation& now) {
    now.servo.frame.calibration = CalibrationState::Ok;
    now.truth.tip = {0, 0, 0.03};
    runs_away(now);
  };
  course.run(60, at_home);
  EXPECT_EQ(course.broken(), "");
}

}  // namespace
}  // namespace thimble::campaign
