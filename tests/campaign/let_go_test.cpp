#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/campaign/good_course.hpp"

// The invariant is seen to hold on a good course and to break on a planted breach.
namespace thimble::campaign {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

TEST(LetGo, HoldsOnAGoodCourse) { EXPECT_EQ(GoodCourse(&make_let_go).broken(), ""); }

TEST(LetGo, SeesAHandThatOpensAndALeaseThatGoesWithoutTheForceFalling) {
  for (const auto let_go : {+[](Observation& now) { now.is_deadman_held = false; },
                            +[](Observation& now) { now.is_wanted = false; }}) {
    GoodCourse course(&make_let_go);
    course.run(21, let_go);
    EXPECT_EQ(course.broken(), "") << "20 ms and a tick are granted";
    course.run(1, let_go);
    EXPECT_THAT(course.broken(), HasSubstr("let go"));
  }
}

TEST(LetGo, HoldsForAForceThatFellInTime) {
  GoodCourse course(&make_let_go);
  int tick = 0;
  course.run(100, [&](Observation& now) {
    now.is_deadman_held = false;
    if (++tick > 20) now.servo.frame.force = {};
  });
  EXPECT_EQ(course.broken(), "");
}

TEST(LetGo, SeesAnArmThatIsDrivenThoughItIsSilent) {
  GoodCourse course(&make_let_go);
  const auto deaf = [](Observation& now) { now.servo.frame.read_status = IoStatus::NoData; };
  course.run(21, deaf);
  EXPECT_EQ(course.broken(), "");
  course.run(1, deaf);
  EXPECT_THAT(course.broken(), HasSubstr("without a fresh sample"));
}

TEST(LetGo, SeesAnArmThatIsDrivenThoughItRunsAway) {
  GoodCourse course(&make_let_go);
  course.run(1, [](Observation& now) { now.servo.frame.velocity = {0, 1.1, 1.1}; });
  EXPECT_THAT(course.broken(), HasSubstr("speed"));
}

TEST(LetGo, SeesWallsThatOutliveTheirWorld) {
  GoodCourse course(&make_let_go);
  const auto silent = [](Observation& now) {
    now.is_network_up = false;
    now.servo.frame.wish = {1, 0, 0};
  };
  course.run(352, silent);
  EXPECT_EQ(course.broken(), "");
  course.run(1, silent);
  EXPECT_THAT(course.broken(), HasSubstr("nothing is heard"));
}

// What is held while the arm is silent has a bound of its own.
TEST(LetGo, JudgesWallsThatOutliveTheirWorldBySamplesOnly) {
  GoodCourse course(&make_let_go);
  const auto silent = [](Observation& now) {
    now.is_network_up = false;
    now.servo.frame.wish = {1, 0, 0};
  };
  course.run(345, silent);
  course.run(20, [&](Observation& now) {
    silent(now);
    now.servo.frame.read_status = IoStatus::NoData;
  });
  EXPECT_EQ(course.broken(), "");
  course.run(1, silent);
  EXPECT_THAT(course.broken(), HasSubstr("nothing is heard"));
}

}  // namespace
}  // namespace thimble::campaign
