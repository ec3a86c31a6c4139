#include "guard/watch.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>

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
      if (++count_ % 2 != 0) continue;
      const bool writes =
          is_gone ? sut.look_alone(now_, is_driven) : sut.look(now_, beats, is_driven);
      if (!writes) continue;
      ++zeros;
      sut.wrote(now_, takes_zero);
    }
    return zeros;
  }

  Watch sut{WatchSettings{}};
  std::uint64_t beats{0};
  bool is_driven{true};
  bool takes_zero{true};
  bool is_gone{false};

 private:
  MonotonicTime now_{};
  int count_{0};
};

TEST(GuardWatch, LeavesAnArmAloneThatIsNotDriven) {
  Course course;
  course.is_driven = false;
  course.run(100, true);
  EXPECT_EQ(course.run(5000, false), 0) << "its firmware may be on its way";
  course.is_gone = true;
  EXPECT_EQ(course.run(5000, false), 0);
  EXPECT_EQ(course.sut.interventions(), 0U);
}

TEST(GuardWatch, CountsTheSilenceFromTheFirstForceOn) {
  Course course;
  course.is_driven = false;
  course.run(1000, false);
  course.is_driven = true;
  EXPECT_EQ(course.run(20, false), 0);
  EXPECT_GT(course.run(20, false), 0);
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

TEST(GuardWatch, FallsSilentAHundredMillisecondsAfterTheFirstZeroThatWasTaken) {
  Course course;
  course.run(1000, true);
  EXPECT_EQ(course.run(5000, false), 51);
  EXPECT_EQ(course.sut.interventions(), 1U) << "one stop is one";
}

TEST(GuardWatch, TriesUntilTheArmTakesAZero) {
  Course course;
  course.run(1000, true);
  course.takes_zero = false;
  EXPECT_EQ(course.run(3020, false), 1500);
  course.takes_zero = true;
  EXPECT_EQ(course.run(3000, false), 51);
}

TEST(GuardWatch, OfADaemonThatIsGoneTheArmIsLetGoAtOnceAndForTenSecondsIfItMustBe) {
  Course course;
  course.run(1000, true);
  course.is_gone = true;
  EXPECT_EQ(course.run(5000, false), 51);

  Course deaf;
  deaf.run(1000, true);
  deaf.is_gone = true;
  deaf.takes_zero = false;
  EXPECT_EQ(deaf.run(30'000, false), 5001);
}

TEST(GuardWatch, WritesZeroOnAfterAStoppedServoRunsAgainUntilItTookTheForceAway) {
  Course course;
  course.run(1000, true);
  course.run(5000, false);
  EXPECT_EQ(course.run(1000, true), 500) << "what was stuck in the process comes out only now";
  course.is_driven = false;
  EXPECT_EQ(course.run(1000, true), 0);
  course.is_driven = true;
  EXPECT_EQ(course.run(1000, true), 0);
  EXPECT_EQ(course.sut.interventions(), 1U);
  course.run(100, false);
  EXPECT_EQ(course.sut.interventions(), 2U);
}

TEST(GuardWatch, CountsFromItsOwnLookWhenItWasAsleepItself) {
  Watch sut{WatchSettings{}};
  ASSERT_FALSE(sut.look(MonotonicTime{milliseconds(1)}, 1, true));
  // The whole machine slept for an hour; the servo ticked once since.
  EXPECT_FALSE(sut.look(MonotonicTime{std::chrono::hours(1)}, 2, true));
}

// Oracle: no zero for an arm that is not driven, nor while the last 20 ms held a beat and no stop
// is unanswered; zero at every look from 20 ms after the last beat to 100 ms after it.
TEST(GuardWatch, KeepsItsPromisesWhateverTheServoDoes) {
  std::mt19937 random(7);
  int zeros = 0;
  for (int round = 0; round < 200; ++round) {
    Watch sut{WatchSettings{}};
    std::uint64_t beats = 0;
    int silent_ms = 0;
    bool is_alive = true;
    bool is_driven = true;
    bool is_unanswered = false;
    for (int ms = 1; ms < 2000; ++ms) {
      if (random() % 40 == 0) is_alive = !is_alive;
      if (is_alive && random() % 20 == 0) is_driven = !is_driven;
      if (is_alive) ++beats;
      silent_ms = is_alive || !is_driven || ms == 1 ? 0 : silent_ms + 1;
      is_unanswered = is_driven && (is_unanswered || silent_ms > 20);
      const bool writes = sut.look(MonotonicTime{milliseconds(ms)}, beats, is_driven);
      if (writes) ++zeros;
      if (writes) sut.wrote(MonotonicTime{milliseconds(ms)}, random() % 3 == 0);
      if (!is_unanswered) {
        ASSERT_FALSE(writes) << ms;
      }
      if (silent_ms > 20 && silent_ms <= 100) {
        ASSERT_TRUE(writes) << ms;
      }
    }
  }
  EXPECT_GT(zeros, 10'000);
}

}  // namespace
}  // namespace thimble::guard
