#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/campaign/good_course.hpp"

// The invariant is seen to hold on a good course and to break on a planted breach.
namespace thimble::campaign {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

void haunted(Observation& now) { now.servo.frame.force = {}; }
void quiet(Observation& now) { now.servo.frame.force = now.truth.motor_force = {}; }
void too_strong(Observation& now) { now.truth.motor_force = {5.6, 0, 0}; }

TEST(UntappedArm, HoldsOnAGoodCourse) {
  GoodCourse course(&make_untapped_arm);
  course.run(8, &haunted);
  course.run(100, &quiet);
  EXPECT_EQ(course.broken(), "");
}

TEST(UntappedArm, SeesMotorsThatNothingTakesTheForceFrom) {
  GoodCourse course(&make_untapped_arm);
  course.run(10, &haunted);
  EXPECT_EQ(course.broken(), "") << "so long is an exchange under way";
  course.run(1, &haunted);
  EXPECT_THAT(course.broken(), HasSubstr("nothing is asked"));
}

TEST(UntappedArm, GrantsABadCableItsTimeAndNoMore) {
  for (const auto disturb :
       {+[](Observation& now) { now.cable_ok_since = now.servo.frame.now; },
        +[](Observation& now) { now.opening_ok_since = now.servo.frame.now; }}) {
    GoodCourse course(&make_untapped_arm);
    course.run(300, [&](Observation& now) {
      haunted(now);
      disturb(now);
    });
    course.run(70, &haunted);
    EXPECT_EQ(course.broken(), "") << "one zero every 50 ms";
    course.run(1, &haunted);
    EXPECT_THAT(course.broken(), HasSubstr("nothing is asked"));
  }
}

TEST(UntappedArm, GrantsALostArmNoLongerThanItTakesToOpenIt) {
  GoodCourse course(&make_untapped_arm);
  const auto lost = [](Observation& now) {
    haunted(now);
    now.servo.frame.state = OperatingState::Lost;
  };
  course.run(1450, lost);
  EXPECT_EQ(course.broken(), "") << "2 s since the beginning: nobody reaches it";
  course.run(11, lost);
  EXPECT_THAT(course.broken(), HasSubstr("nothing is asked"));
}

TEST(UntappedArm, SeesANormBeyondTheLimitButForAPoseThatWasReadWrong) {
  GoodCourse course(&make_untapped_arm);
  course.run(60, [](Observation& now) {
    ++now.spoilt_in;
    too_strong(now);
  });
  EXPECT_EQ(course.broken(), "");
  course.run(61, &too_strong);
  EXPECT_THAT(course.broken(), HasSubstr("norm of the force at the arm"));
}

TEST(UntappedArm, GrantsABadCableThePoseThatAHandBringsTheArmTo) {
  GoodCourse course(&make_untapped_arm);
  course.run(300, [](Observation& now) {
    now.cable_ok_since = now.servo.frame.now;
    too_strong(now);
  });
  course.run(70, &too_strong);
  EXPECT_EQ(course.broken(), "") << "it may not have been heard yet";
  course.run(1, &too_strong);
  EXPECT_THAT(course.broken(), HasSubstr("norm of the force at the arm"));
}

TEST(UntappedArm, GrantsALostArmThePoseThatAHandBringsItTo) {
  GoodCourse course(&make_untapped_arm);
  course.run(300, [](Observation& now) {
    now.servo.frame.state = OperatingState::Lost;
    too_strong(now);
  });
  EXPECT_EQ(course.broken(), "");
  course.run(61, &too_strong);
  EXPECT_THAT(course.broken(), HasSubstr("norm of the force at the arm"));
}

TEST(UntappedArm, SeesWhatIsNotFinite) {
  GoodCourse course(&make_untapped_arm);
  course.run(1, [](Observation& now) { now.truth.motor_force.y = 1.0 / 0.0; });
  EXPECT_THAT(course.broken(), HasSubstr("finite"));
}

}  // namespace
}  // namespace thimble::campaign
