#include "hal/base/burst_pause.hpp"

#include <gtest/gtest.h>

#include <random>

namespace thimble {
namespace {

using std::chrono::microseconds;

TEST(BurstPause, LetsAFewWakesPassAtOnce) {
  BurstPause sut;
  MonotonicTime now{};
  for (int i = 1; i < BurstPause::kMost; ++i) {
    EXPECT_EQ(sut.after_wake(now), Duration::zero());
    now = now + microseconds(30);
  }
  EXPECT_EQ(sut.after_wake(now), MonotonicTime{} + BurstPause::kWindow - now);
}

TEST(BurstPause, IsNoneForWhoIsWokenNowAndThen) {
  BurstPause sut;
  MonotonicTime now{};
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(sut.after_wake(now), Duration::zero());
    now = now + BurstPause::kWindow;
  }
}

// Who obeys it is woken no more often than kMost times a window, however it is called, and
// waits no longer than a window.
TEST(BurstPause, BoundsAnyStorm) {
  std::mt19937 random(5);
  BurstPause sut;
  MonotonicTime now{};
  int wakes = 0;
  while (now.since_epoch < std::chrono::seconds(1)) {
    ++wakes;
    const Duration pause = sut.after_wake(now);
    EXPECT_GE(pause, Duration::zero());
    EXPECT_LE(pause, BurstPause::kWindow);
    now = now + (pause + microseconds(random() % 40));
  }
  EXPECT_LE(wakes, std::chrono::seconds(1) / BurstPause::kWindow * BurstPause::kMost + 1);
  EXPECT_GT(wakes, 1000);
}

}  // namespace
}  // namespace thimble
