#include "sim/time/real_time_brake.hpp"

#include <gtest/gtest.h>

#include <random>

namespace thimble::sim {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

// A machine's clock under the test's hand: sleeping jumps, plus the stall that was ordered.
class StallableClock final : public Clock {
 public:
  MonotonicTime now() const noexcept override { return now_; }
  Duration sleep_until(MonotonicTime deadline) noexcept override {
    if (now_ < deadline) now_ = deadline;
    now_ = now_ + stall_;
    stall_ = {};
    return now_ - deadline;
  }
  void work_for(Duration duration) { now_ = now_ + duration; }
  void stall_next_sleep(Duration duration) { stall_ = duration; }

 private:
  MonotonicTime now_{Duration(milliseconds(7))};
  Duration stall_{};
};

struct RealTimeBrakeTest : testing::Test {
  VirtualClock virtual_clock{MonotonicTime{milliseconds(100)}};
  StallableClock real_clock;
  RealTimeBrake sut{virtual_clock, real_clock};
  MonotonicTime next = virtual_clock.now();

  Duration tick() {
    next = next + milliseconds(1);
    return sut.sleep_until(next);
  }
};

TEST_F(RealTimeBrakeTest, VirtualTimeFollowsTheRealClock) {
  const MonotonicTime real_start = real_clock.now();
  for (int i = 0; i < 10; ++i) EXPECT_EQ(tick(), Duration(0));

  EXPECT_EQ(sut.now(), MonotonicTime{milliseconds(110)});
  EXPECT_EQ(real_clock.now() - real_start, milliseconds(10));
  EXPECT_EQ(sut.reanchors(), 0U);
}

TEST_F(RealTimeBrakeTest, ALatenessWithinTheToleranceIsCaughtUp) {
  const MonotonicTime real_start = real_clock.now();
  for (int i = 0; i < 100; ++i) {
    real_clock.stall_next_sleep(kBrakeTolerance);
    EXPECT_EQ(tick(), kBrakeTolerance);
  }
  EXPECT_EQ(real_clock.now() - real_start, milliseconds(100) + kBrakeTolerance);
  EXPECT_EQ(sut.reanchors(), 0U);
  EXPECT_EQ(sut.total_delay(), Duration(0));
}

TEST_F(RealTimeBrakeTest, AfterALateWakeUpVirtualTimeGoesOnWhereItWas) {
  tick();
  real_clock.stall_next_sleep(milliseconds(30));
  EXPECT_EQ(tick(), milliseconds(30));
  const MonotonicTime real_resumed = real_clock.now();

  for (int i = 0; i < 5; ++i) EXPECT_EQ(tick(), Duration(0));

  EXPECT_EQ(real_clock.now() - real_resumed, milliseconds(5)) << "no burst to catch up";
  EXPECT_EQ(sut.reanchors(), 1U);
  EXPECT_EQ(sut.total_delay(), milliseconds(30));
}

TEST_F(RealTimeBrakeTest, ALateCallerIsTreatedLikeALateWakeUp) {
  tick();
  real_clock.work_for(milliseconds(11));
  EXPECT_EQ(tick(), milliseconds(10));
  EXPECT_EQ(sut.now(), next);
  EXPECT_EQ(sut.total_delay(), milliseconds(10));
}

TEST_F(RealTimeBrakeTest, TheWaitBeforeTheFirstSleepIsNoLateness) {
  real_clock.work_for(std::chrono::seconds(3));
  EXPECT_EQ(tick(), Duration(0));
  EXPECT_EQ(sut.total_delay(), Duration(0));
}

TEST_F(RealTimeBrakeTest, ADeadlineInThePastDoesNotSleep) {
  tick();
  const MonotonicTime real_now = real_clock.now();
  EXPECT_EQ(sut.sleep_until(next - milliseconds(1)), milliseconds(1));
  EXPECT_EQ(real_clock.now(), real_now);
  EXPECT_EQ(sut.now(), next);
}

// Whatever the host does, the books balance: real time = virtual time + delay + jitter.
TEST_F(RealTimeBrakeTest, RealTimeIsVirtualTimePlusTheDelay) {
  std::mt19937 random(11);
  tick();
  const MonotonicTime real_start = real_clock.now();
  const MonotonicTime virtual_start = sut.now();
  for (int i = 0; i < 5000; ++i) {
    if (random() % 3 == 0) real_clock.stall_next_sleep(microseconds(random() % 1500));
    if (random() % 5 == 0) real_clock.work_for(microseconds(random() % 3000));
    const MonotonicTime before = sut.now();
    tick();
    ASSERT_EQ(sut.now() - before, milliseconds(1)) << "virtual time steps evenly";
    const Duration jitter =
        (real_clock.now() - real_start) - (sut.now() - virtual_start) - sut.total_delay();
    ASSERT_GE(jitter, Duration(0));
    ASSERT_LE(jitter, kBrakeTolerance);
  }
  EXPECT_GT(sut.reanchors(), 0U);
}

}  // namespace
}  // namespace thimble::sim
