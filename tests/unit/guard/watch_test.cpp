#include "guard/watch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <limits>
#include <optional>
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
      if (is_alive) beat_at_ = now_;
      if (++count_ % 2 != 0) continue;
      const bool writes =
          is_gone ? sut.look_alone(now_, drive != 0) : sut.look(now_, beat_at_, drive);
      if (!writes) continue;
      ++zeros;
      sut.wrote(now_, takes_zero);
    }
    return zeros;
  }

  Watch sut{WatchSettings{}};
  std::uint32_t drive{1};
  bool takes_zero{true};
  bool is_gone{false};

 private:
  MonotonicTime now_{};
  MonotonicTime beat_at_{};
  int count_{0};
};

TEST(GuardWatch, LeavesAnArmAloneThatIsNotDriven) {
  Course course;
  course.drive = 0;
  course.run(100, true);
  EXPECT_EQ(course.run(5000, false), 0) << "its firmware may be on its way";
  course.is_gone = true;
  EXPECT_EQ(course.run(5000, false), 0);
  EXPECT_EQ(course.sut.interventions(), 0U);
}

TEST(GuardWatch, CountsTheSilenceFromTheFirstForceOn) {
  Course course;
  course.drive = 0;
  course.run(1000, false);
  course.drive = 1;
  EXPECT_EQ(course.run(18, false), 0) << "from the look before it on, 2 ms ago";
  EXPECT_GT(course.run(4, false), 0);
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

TEST(GuardWatch, OfADaemonThatIsGoneTheArmIsLetGoAtOnceAndFor25SecondsIfItMustBe) {
  Course course;
  course.run(1000, true);
  course.is_gone = true;
  EXPECT_EQ(course.run(5000, false), 51);

  Course deaf;
  deaf.run(1000, true);
  deaf.is_gone = true;
  deaf.takes_zero = false;
  EXPECT_EQ(deaf.run(60'000, false), 12'501);
}

TEST(GuardWatch, WritesZeroOnAfterAStoppedServoRunsAgainUntilItTookTheForceAway) {
  Course course;
  course.run(1000, true);
  course.run(5000, false);
  EXPECT_EQ(course.run(1000, true), 500) << "what was stuck in the process comes out only now";
  course.drive = 0;
  EXPECT_EQ(course.run(1000, true), 0);
  course.drive = 1;
  EXPECT_EQ(course.run(1000, true), 0);
  EXPECT_EQ(course.sut.interventions(), 1U);
  course.run(100, false);
  EXPECT_EQ(course.sut.interventions(), 2U);
}

// Of a drive that ended and another that began between two of its looks.
TEST(GuardWatch, AnotherDriveSaysThatTheForceBeforeWasTakenAway) {
  Course course;
  course.run(1000, true);
  course.run(30, false);
  EXPECT_GT(course.run(10, true), 0) << "the same drive";
  course.drive = 2;
  EXPECT_EQ(course.run(1000, true), 0);
  EXPECT_EQ(course.sut.interventions(), 1U);
  course.run(30, false);
  EXPECT_EQ(course.sut.interventions(), 2U) << "it is watched as the one before";
}

TEST(GuardWatch, ABeatSinceTheMachineSleptIsEnough) {
  Watch sut{WatchSettings{}};
  ASSERT_FALSE(sut.look(MonotonicTime{milliseconds(1)}, MonotonicTime{milliseconds(1)}, 1));
  // The whole machine slept for an hour; the servo ticked once since.
  const MonotonicTime awake{std::chrono::hours(1)};
  EXPECT_FALSE(sut.look(awake, awake - milliseconds(1), 1));
}

// Oracle: no zero for an arm that is not driven, nor while the last 20 ms held a beat and no stop
// is unanswered; zero at every look from 20 ms after the last beat to 100 ms after it.
TEST(GuardWatch, KeepsItsPromisesWhateverTheServoDoes) {
  std::mt19937 random(7);
  int zeros = 0;
  for (int round = 0; round < 200; ++round) {
    Watch sut{WatchSettings{}};
    MonotonicTime beat_at{milliseconds(1)};
    int silent_ms = 0;
    bool is_alive = true;
    bool is_driven = true;
    bool is_unanswered = false;
    for (int ms = 1; ms < 2000; ++ms) {
      if (random() % 40 == 0) is_alive = !is_alive;
      if (is_alive && random() % 20 == 0) is_driven = !is_driven;
      if (is_alive) beat_at = {milliseconds(ms)};
      silent_ms = is_alive || !is_driven || ms == 1 ? 0 : silent_ms + 1;
      is_unanswered = is_driven && (is_unanswered || silent_ms > 20);
      const bool writes = sut.look(MonotonicTime{milliseconds(ms)}, beat_at, is_driven ? 1 : 0);
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

// A servo of 1 kHz at any phase, and a guard that sleeps from next_look() to next_look().
class Sleeper {
 public:
  explicit Sleeper(Duration phase, Duration period = milliseconds(1))
      : phase_(phase), period_(period) {}

  // Looks until `end`; the first zero's time.
  std::optional<MonotonicTime> run(MonotonicTime end) {
    for (; now < end; now = sut.next_look(now)) {
      ++looks;
      const bool is_driven = now >= driven_at;
      if (sut.look(now, last_beat(), is_driven ? 1 : 0)) return now;
      EXPECT_GT(sut.next_look(now), now);
      EXPECT_LE(sut.next_look(now), now + milliseconds(20) + Duration(1));
    }
    return std::nullopt;
  }
  // At or before now, of a servo that ended at `dead_at`.
  [[nodiscard]] MonotonicTime last_beat() const {
    const Duration lived = std::min(now, dead_at) - MonotonicTime{phase_};
    return MonotonicTime{phase_ + lived / period_ * period_};
  }

  Watch sut{WatchSettings{}};
  MonotonicTime now{std::chrono::seconds(1)};
  MonotonicTime driven_at{};
  MonotonicTime dead_at{std::chrono::hours(1)};
  int looks{0};

 private:
  Duration phase_;
  Duration period_;
};

TEST(GuardWatch, LooksSeldomAtAServoThatLives) {
  for (const bool is_driven : {false, true}) {
    Sleeper course(std::chrono::microseconds(700));
    if (!is_driven) course.driven_at = MonotonicTime{std::chrono::hours(1)};
    EXPECT_FALSE(course.run(MonotonicTime{std::chrono::seconds(11)}));
    EXPECT_LE(course.looks, is_driven ? 530 : 1001) << "in ten seconds";
  }
}

TEST(GuardWatch, WakesBesideTheTicksAndNotWithThem) {
  for (const int rate_hz : {500, 1000, 2000, 4000}) {
    const Duration period = std::chrono::nanoseconds(1'000'000'000 / rate_hz);
    Sleeper course(std::chrono::microseconds(123), period);
    (void)course.run(course.now + milliseconds(100));  // until it is in step
    for (int i = 0; i < 100; ++i) {
      const Duration after = course.now - course.last_beat();
      EXPECT_GE(after, std::chrono::microseconds(90)) << rate_hz;
      EXPECT_LE(after, period - std::chrono::microseconds(90)) << rate_hz;
      (void)course.run(course.now + Duration(1));
    }
  }
}

TEST(GuardWatch, LetsGoAsSoonAsTheLastBeatIsTooOldHoweverSeldomItLooks) {
  std::mt19937 random(459);
  for (int round = 0; round < 1000; ++round) {
    Sleeper course(std::chrono::microseconds(random() % 1000));
    course.driven_at = course.now + std::chrono::microseconds(random() % 100'000);
    course.dead_at = course.driven_at + std::chrono::microseconds(random() % 100'000);
    const auto zero = course.run(course.now + std::chrono::seconds(1));
    ASSERT_TRUE(zero);
    EXPECT_EQ(*zero - course.last_beat(), milliseconds(20) + Duration(1));
  }
}

// Of ticks that come and last as they like, and a guard that oversleeps. Each is a beginning and an
// end, at which the page is told of it.
TEST(GuardWatch, LeavesAServoAloneWhoseTicksEndInTimeAndNoOther) {
  std::mt19937 random(460);
  const auto up_to = [&](int us) { return std::chrono::microseconds(random() % unsigned(us)); };
  for (int round = 0; round < 1000; ++round) {
    Watch sut{WatchSettings{}};
    MonotonicTime now{std::chrono::seconds(1)};
    MonotonicTime began = now;
    MonotonicTime told = now;
    MonotonicTime ends = now;
    const MonotonicTime dies = now + up_to(300'000);
    bool is_let_go = false;
    while (!is_let_go && now < dies + std::chrono::seconds(1)) {
      while (ends <= now && began < dies) {
        told = began;
        began = ends + up_to(9'000);
        ends = began + up_to(5'000);  // no beat is older than 19 ms before the next
      }
      is_let_go = sut.look(now, told, 1);
      if (is_let_go) {
        ASSERT_GT(now - told, milliseconds(20));
        ASSERT_GE(began, dies);
      } else {
        now = sut.next_look(now) + (random() % 4 == 0 ? up_to(30'000) : Duration(0));
      }
    }
    ASSERT_TRUE(is_let_go);
    EXPECT_LE(now - told, milliseconds(50)) << "20 and what it overslept";
  }
}

// What stands in the page is the daemon's word: it can be anything.
TEST(GuardWatch, NoBeatOfAnotherTimeKeepsItFromLooking) {
  const std::array<std::int64_t, 6> lies{0,
                                         -1,
                                         1,
                                         std::numeric_limits<std::int64_t>::max(),
                                         std::numeric_limits<std::int64_t>::min(),
                                         std::int64_t{5'000'000'000}};
  for (const std::int64_t lie : lies) {
    Watch sut{WatchSettings{}};
    MonotonicTime now{std::chrono::seconds(1)};
    const MonotonicTime first = now;
    while (!sut.look(now, MonotonicTime{Duration(lie)}, 1)) {
      const MonotonicTime next = sut.next_look(now);
      ASSERT_GT(next, now) << lie;
      ASSERT_LE(next, now + milliseconds(20) + Duration(1)) << lie;
      now = next;
    }
    EXPECT_LE(now - first, milliseconds(20) + Duration(1)) << lie;
  }
}

TEST(GuardWatch, BeatsOfAClockThatIsAheadAreNone) {
  Watch sut{WatchSettings{}};
  MonotonicTime now{std::chrono::seconds(1)};
  const MonotonicTime first = now;
  while (!sut.look(now, now + std::chrono::seconds(1), 1)) now = sut.next_look(now);
  EXPECT_LE(now - first, milliseconds(20) + Duration(1));
}

}  // namespace
}  // namespace thimble::guard
