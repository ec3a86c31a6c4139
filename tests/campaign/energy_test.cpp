#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/campaign/good_course.hpp"

// The invariant is seen to hold on a good course and to break on a planted breach.
namespace thimble::campaign {
namespace {

using testing::HasSubstr;

// The tip is pushed to and fro in a wall of 800 N/m, `back` times as hard on the way back.
void push_and_return(GoodCourse& course, double back, const Observation& quirk) {
  const auto rest = [](Observation& now) {
    now.servo.frame.is_limited = false;
    now.truth.motor_force = {};
    now.truth.tip = {};
  };
  course.run(200, rest);
  for (int i = 1; i <= 40; ++i) {
    const double depth_m = 1e-4 * (i <= 20 ? i : 40 - i);
    course.run(1, [&](Observation& now) {
      now.servo.frame.is_limited = quirk.servo.frame.is_limited;
      now.truth.tip_velocity = quirk.truth.tip_velocity;
      now.world_ok_since = quirk.world_ok_since;
      now.tip_ok_since = quirk.tip_ok_since;
      now.servo.frame.contacts = 1;
      now.servo.frame.wish = {-800 * depth_m, 0, 0};
      now.truth.motor_force = {-(i <= 20 ? 800 : back * 800) * depth_m, 0, 0};
      now.truth.tip = {depth_m, 0, 0};
    });
  }
  course.run(1, rest);
}
std::string push_and_return(double back, const Observation& quirk) {
  GoodCourse course(&make_energy);
  push_and_return(course, back, quirk);
  return course.broken();
}

TEST(Energy, TellsHowManyTouchesItJudged) {
  GoodCourse course(&make_energy);
  Observation quirk;
  for (const bool is_limited : {false, true, true, false, true}) {
    quirk.servo.frame.is_limited = is_limited;
    push_and_return(course, 1, quirk);
  }
  EXPECT_EQ(course.broken(), "");
  EXPECT_EQ(course.judged().touches, 2U);
  EXPECT_EQ(course.judged().excused_touches, 3U + 1)
      << "and the one that the good course begins with";
}

TEST(Energy, HoldsForASpringAndSeesOneThatGivesMoreThanItTook) {
  Observation quirk;
  EXPECT_EQ(push_and_return(1, quirk), "");
  EXPECT_EQ(push_and_return(1.2, quirk), "") << "0.3 mJ: one contact, and the way";
  EXPECT_THAT(push_and_return(1.5, quirk), HasSubstr("energy"));
  quirk.servo.frame.is_limited = true;
  EXPECT_EQ(push_and_return(1.5, quirk), "") << "a touch that met the limiter is not judged";
  quirk.servo.frame.is_limited = false;
  quirk.truth.tip_velocity = {0.31, 0, 0};
  EXPECT_EQ(push_and_return(1.5, quirk), "") << "nor one of a tip that is shoved";
  quirk.truth.tip_velocity = {};
  EXPECT_THAT(push_and_return(1.5, quirk), HasSubstr("energy"));
  quirk.world_ok_since = {};
  EXPECT_EQ(push_and_return(1.5, quirk), "") << "nor one in a world that moves";
  quirk.world_ok_since = Observation{}.world_ok_since;
  quirk.tip_ok_since = MonotonicTime{std::chrono::milliseconds(800)};  // when it is touched
  EXPECT_EQ(push_and_return(1.5, quirk), "") << "nor one of a tip that is shoved slowly";
}

// Walls that come back from a silence while the finger is in them: 3.3 mJ by the growing gain.
std::string return_of_walls(bool is_after_silence) {
  GoodCourse course(&make_energy);
  course.run(200, [&](Observation& now) {
    now.servo.frame.is_fading = is_after_silence;
    now.truth.motor_force = {};
    now.truth.tip = {};
  });
  for (int i = 1; i <= 100; ++i) {
    const double depth_m = 1e-4 * (i <= 50 ? i : 100 - i);
    course.run(1, [&](Observation& now) {
      now.servo.frame.is_fading = false;
      now.servo.frame.wish = {-800 * depth_m * i / 100, 0, 0};
      now.truth.motor_force = now.servo.frame.wish;
      now.truth.tip = {depth_m, 0, 0};
    });
  }
  return course.broken();
}

TEST(Energy, GrantsWhatWallsAddThatComeBackAfterASilence) {
  EXPECT_EQ(return_of_walls(true), "");
  EXPECT_THAT(return_of_walls(false), HasSubstr("energy"));
}

TEST(Energy, CountsTheContactThatBeginsATouchThoughItsForceIsStillOnTheWay) {
  for (const std::uint32_t contacts : {1U, 8U}) {
    GoodCourse course(&make_energy);
    const auto rest = [](Observation& now) {
      now.truth.motor_force = {};
      now.truth.tip = {0.001, 0, 0};
      now.servo.frame.wish = {};
    };
    course.run(200, rest);
    const auto found = [&](Observation& now) {
      rest(now);
      now.servo.frame.wish = {-1, 0, 0};
      now.servo.frame.contacts = contacts;
    };
    course.run(2, found);
    // 1 mm by 1 N: 1 mJ, where a touch of one contact is granted 0.6.
    for (int i = 9; i >= 0; --i) {
      course.run(1, [&](Observation& now) {
        found(now);
        now.truth.motor_force = {-1, 0, 0};
        now.truth.tip = {1e-4 * i, 0, 0};
      });
    }
    EXPECT_EQ(course.broken().empty(), contacts == 8) << contacts;
  }
}

}  // namespace
}  // namespace thimble::campaign
