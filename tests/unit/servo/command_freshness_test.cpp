#include "daemon/servo/command_freshness.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>

namespace thimble::servo {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr MonotonicTime kFirstWrite{std::chrono::seconds(1)};
constexpr Duration kNewSample{};

// A way out that takes one command in every `period`, whenever the first comes, and none while it
// is blocked: what the mailboxes of a bus say (UsbMailboxes).
struct WayOut {
  Duration period;
  MonotonicTime free_at{kFirstWrite};
  MonotonicTime blocked_until{};

  bool takes(MonotonicTime now) {
    if (now < free_at || now < blocked_until) return false;
    free_at = now + period;
    return true;
  }
};

FreshnessSettings of_period(Duration period) {
  FreshnessSettings settings;
  settings.exchange_period = period;
  return settings;
}

// As HID (1 ms), a serial line (an answer in every second tick) and a Falcon (2 ms, decision 0259)
// take them, at every rate of a servo, which is late by chance.
TEST(CommandFreshness, AHealthyArmNeverCounts) {
  std::mt19937 dice(5);
  for (const int rate_hz : {500, 1000, 4000, 8000}) {
    for (const int way_ms : {1, 2}) {
      const Duration tick = std::chrono::nanoseconds(1'000'000'000 / rate_hz);
      CommandFreshness sut{of_period(milliseconds(way_ms))};
      WayOut way{.period = milliseconds(way_ms) - microseconds(20)};
      MonotonicTime now = kFirstWrite;
      for (int i = 0; i < 20'000; ++i) {
        now = now + tick + microseconds(dice() % 50);
        if (dice() % 500 == 0) now = now + milliseconds(dice() % 15);  // the servo was away
        sut.judge(now, way.takes(now), kNewSample);
      }
      EXPECT_EQ(sut.missed(), 0U) << rate_hz << " Hz, " << way_ms << " ms";
      EXPECT_FALSE(sut.is_full());
    }
  }
}

TEST(CommandFreshness, ACommandThatWaitsForOneMorePeriodIsNoMiss) {
  CommandFreshness sut{of_period(milliseconds(1))};
  for (int tick = 1; tick <= 3000; ++tick)
    sut.judge(kFirstWrite + milliseconds(tick), tick % 3 == 0, kNewSample);
  EXPECT_EQ(sut.missed(), 0U);
}

// Two periods fewer than it lasts: that in which the way out is found shut, and that in which the
// command may still be on its way.
TEST(CommandFreshness, ABlockCountsItsPeriods) {
  std::mt19937 dice(9);
  for (const int period_us : {500, 1000, 2000}) {
    for (int round = 0; round < 200; ++round) {
      const Duration period = microseconds(period_us);
      const Duration block = microseconds(dice() % 400'000);
      CommandFreshness sut{of_period(period)};
      MonotonicTime now = kFirstWrite;
      for (; now - kFirstWrite < block; now = now + microseconds(125))
        sut.judge(now, false, kNewSample);
      sut.judge(now, true, kNewSample);
      const std::int64_t least = std::max<std::int64_t>(block / period - 2, 0);
      EXPECT_GE(sut.missed(), static_cast<std::uint64_t>(least)) << block.count();
      EXPECT_LE(sut.missed(), static_cast<std::uint64_t>(block / period)) << block.count();
    }
  }
}

TEST(CommandFreshness, RepeatedBlocksFillTheBucketAndOneOfTwentyMillisecondsDoesNot) {
  CommandFreshness sut{of_period(milliseconds(1))};
  int ms = 0;
  for (; ms < 20; ++ms) sut.judge(kFirstWrite + milliseconds(ms), false, kNewSample);
  EXPECT_FALSE(sut.is_full());
  while (!sut.is_full() && ms < 100) {
    ++ms;
    sut.judge(kFirstWrite + milliseconds(ms), ms % 10 == 0, kNewSample);
  }
  EXPECT_LT(ms, 40);
}

// A controller in lock-step says nothing either: SampleFreshness has these.
TEST(CommandFreshness, WhatFailsBothWaysIsNotCountedTwice) {
  CommandFreshness sut{of_period(milliseconds(1))};
  const auto wait_until = [&](int ms, int end_ms, Duration sample_age) {
    for (; ms < end_ms; ++ms) sut.judge(kFirstWrite + milliseconds(ms), false, sample_age);
  };
  wait_until(0, 5, kNewSample);
  EXPECT_EQ(sut.missed(), 3U);
  wait_until(5, 50, milliseconds(2));
  EXPECT_EQ(sut.missed(), 3U);
  wait_until(50, 55, milliseconds(1));
  EXPECT_EQ(sut.missed(), 8U) << "samples come again, the way out is shut still";
}

TEST(CommandFreshness, ARestartEmptiesTheBucketAndKeepsTheCount) {
  CommandFreshness sut{of_period(milliseconds(1))};
  for (int ms = 0; ms < 50; ++ms) sut.judge(kFirstWrite + milliseconds(ms), false, kNewSample);
  EXPECT_TRUE(sut.is_full());
  const std::uint64_t missed = sut.missed();
  sut.restart();
  sut.judge(kFirstWrite + milliseconds(50), false, kNewSample);
  EXPECT_FALSE(sut.is_full());
  EXPECT_EQ(sut.missed(), missed);
}

}  // namespace
}  // namespace thimble::servo
