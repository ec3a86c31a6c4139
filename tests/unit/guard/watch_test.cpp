#include "guard/watch.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <vector>

namespace thimble::guard {
namespace {

using std::chrono::milliseconds;

// A servo and the guard's look at it every 2 ms, as the program does.
class Course {
 public:
  // Zeros written in `ms` of a servo that beats or does not.
  int run(int ms, bool is_alive) {
    int zeros = 0;
    for (int i = 0; i < ms; ++i) {
      now_ = now_ + milliseconds(1);
      if (is_alive) ++beats;
      if (++count_ % 2 == 0 && sut.look(now_, beats, acknowledged)) ++zeros;
    }
    return zeros;
  }

  Watch sut{WatchSettings{}};
  std::uint64_t beats{0};
  std::uint32_t acknowledged{0};

 private:
  MonotonicTime now_{};
  int count_{0};
};

TEST(GuardWatch, LeavesAnArmAloneWhoseServoNeverTicked) {
  Course course;
  EXPECT_EQ(course.run(5000, false), 0);
  EXPECT_EQ(course.sut.interventions(), 0U);
}

TEST(GuardWatch, LeavesAnArmAloneWhoseServoLives) {
  Course course;
  EXPECT_EQ(course.run(5000, true), 0);
  EXPECT_EQ(course.run(18, false), 0) << "as late as a servo may be";
  EXPECT_EQ(course.run(1000, true), 0);
  EXPECT_EQ(course.sut.interventions(), 0U);
}

TEST(GuardWatch, LetsTheArmGoAfterTwentyMilliseconds) {
  Course course;
  course.run(1000, true);
  EXPECT_EQ(course.run(20, false), 0);
  EXPECT_EQ(course.run(2, false), 1);
  EXPECT_EQ(course.sut.interventions(), 1U);
}

TEST(GuardWatch, FallsSilentAfterAHundredMillisecondsOfZero) {
  Course course;
  course.run(1000, true);
  EXPECT_EQ(course.run(20, false), 0);
  EXPECT_EQ(course.run(5000, false), 51);
  EXPECT_EQ(course.sut.interventions(), 1U) << "one stop is one";
}

TEST(GuardWatch, WritesZeroOnAfterAStoppedServoRunsAgainUntilItTookNotice) {
  Course course;
  course.run(1000, true);
  course.run(5000, false);
  EXPECT_EQ(course.run(1000, true), 500) << "what was stuck in the process comes out only now";
  course.acknowledged = 1;
  EXPECT_EQ(course.run(1000, true), 0);
  EXPECT_EQ(course.sut.interventions(), 1U);
}

TEST(GuardWatch, IsNotPutOffByANoticeOfAnEarlierStop) {
  Course course;
  course.run(1000, true);
  course.run(100, false);
  course.acknowledged = 1;
  course.run(100, true);
  course.run(100, false);
  EXPECT_EQ(course.sut.interventions(), 2U);
  EXPECT_EQ(course.run(100, true), 50);
}

TEST(GuardWatch, CountsFromItsOwnLookWhenItWasAsleepItself) {
  Watch sut{WatchSettings{}};
  ASSERT_FALSE(sut.look(MonotonicTime{milliseconds(1)}, 1, 0));
  // The whole machine slept for an hour; the servo ticked once since.
  EXPECT_FALSE(sut.look(MonotonicTime{std::chrono::hours(1)}, 2, 0));
}

// Oracle: no zero while the last 20 ms held a beat and nothing is owed; zero at every look from 20
// ms after the last beat to 100 ms after it.
TEST(GuardWatch, KeepsItsTwoPromisesWhateverTheServoDoes) {
  std::mt19937 random(7);
  for (int round = 0; round < 200; ++round) {
    Watch sut{WatchSettings{}};
    std::uint64_t beats = 0;
    std::uint32_t acknowledged = 0;
    int silent_ms = 0;
    bool is_alive = true;
    for (int ms = 1; ms < 2000; ++ms) {
      if (random() % 40 == 0) is_alive = !is_alive;
      if (is_alive) ++beats;
      silent_ms = is_alive ? 0 : silent_ms + 1;
      if (is_alive && random() % 4 == 0) acknowledged = sut.interventions();
      const bool was_owed = acknowledged != sut.interventions();
      const bool writes = sut.look(MonotonicTime{milliseconds(ms)}, beats, acknowledged);
      if (beats == 0) {
        EXPECT_FALSE(writes);
        continue;
      }
      if (silent_ms <= 20 && !was_owed) {
        ASSERT_FALSE(writes) << ms;
      }
      if (silent_ms > 20 && silent_ms <= 100) {
        ASSERT_TRUE(writes) << ms;
      }
    }
  }
}

}  // namespace
}  // namespace thimble::guard
