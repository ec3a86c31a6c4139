#include "daemon/servo/sample_freshness.hpp"

#include <gtest/gtest.h>

#include <random>

namespace thimble::servo {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr MonotonicTime kStart{std::chrono::seconds(1)};

SampleFreshness started() {
  SampleFreshness sut{FreshnessSettings{}};
  sut.restart(kStart);
  return sut;
}

TEST(SampleFreshness, HoldsForThreeMillisecondsThenRampsOut) {
  SampleFreshness sut = started();
  EXPECT_EQ(sut.judge(kStart + milliseconds(3), kStart, false).gain, 1);
  EXPECT_NEAR(sut.judge(kStart + milliseconds(13), kStart, false).gain, 0.5, 1e-9);
}

TEST(SampleFreshness, FaultsWithZeroAtTwentyMillisecondsAtTheLatest) {
  SampleFreshness sut = started();
  for (int ms = 1; ms < 20; ++ms) {
    ASSERT_EQ(sut.judge(kStart + milliseconds(ms), kStart, false).fault, FaultCode::None);
  }
  const FreshnessVerdict verdict = sut.judge(kStart + milliseconds(20), kStart, false);

  EXPECT_EQ(verdict.fault, FaultCode::StaleSample);
  EXPECT_EQ(verdict.gain, 0);
}

TEST(SampleFreshness, TwoClocksBeatingAgainstEachOtherMissNothing) {
  SampleFreshness sut = started();
  // The device samples every 1.0007 ms, the servo ticks every 1 ms: now and then a tick finds
  // nothing new although every sample arrives.
  Duration device{};
  for (int tick = 1; tick <= 100'000; ++tick) {
    const Duration now = milliseconds(tick);
    bool is_fresh = false;
    while (device + microseconds(1000) + Duration(700) <= now) {
      device += microseconds(1000) + Duration(700);
      is_fresh = true;
    }
    ASSERT_EQ(sut.judge(kStart + now, kStart + device, is_fresh).fault, FaultCode::None);
  }
  EXPECT_EQ(sut.missed(), 0U);
}

TEST(SampleFreshness, AFastServoDoesNotCountTheTicksBetweenSamples) {
  SampleFreshness sut = started();
  for (int tick = 1; tick <= 80'000; ++tick) {
    const Duration now = microseconds(125) * tick;
    const bool is_fresh = tick % 8 == 0;
    const Duration sampled = milliseconds(tick / 8);
    ASSERT_EQ(sut.judge(kStart + now, kStart + sampled, is_fresh).fault, FaultCode::None);
  }
  EXPECT_EQ(sut.missed(), 0U);
}

TEST(SampleFreshness, ASteadyLossOfOneInEightNeverFaults) {
  SampleFreshness sut = started();
  MonotonicTime sampled = kStart;
  for (int tick = 1; tick <= 10'000; ++tick) {
    const MonotonicTime now = kStart + milliseconds(tick);
    const bool is_fresh = tick % 8 != 0;
    if (is_fresh) sampled = now;
    ASSERT_EQ(sut.judge(now, sampled, is_fresh).fault, FaultCode::None);
  }
}

TEST(SampleFreshness, RepeatedOutagesFillTheBucket) {
  SampleFreshness sut = started();
  MonotonicTime sampled = kStart;
  FaultCode fault = FaultCode::None;
  int tick = 0;
  while (fault == FaultCode::None && tick < 1000) {  // 9 ms without, 1 ms with a sample
    const MonotonicTime now = kStart + milliseconds(++tick);
    const bool is_fresh = tick % 10 == 0;
    if (is_fresh) sampled = now;
    fault = sut.judge(now, sampled, is_fresh).fault;
  }
  EXPECT_EQ(fault, FaultCode::MissedExchanges);
  EXPECT_LE(tick, 40);
}

TEST(SampleFreshness, TellsWhenAnOutageEnds) {
  SampleFreshness sut = started();
  sut.judge(kStart + milliseconds(5), kStart, false);
  const MonotonicTime back = kStart + milliseconds(6);
  EXPECT_TRUE(sut.judge(back, back, true).is_outage_over);
  EXPECT_FALSE(sut.judge(back + milliseconds(1), back + milliseconds(1), true).is_outage_over);
}

TEST(SampleFreshness, TheGainNeverRisesWhileNothingComes) {
  std::mt19937 random(5);
  SampleFreshness sut = started();
  double previous = 1;
  MonotonicTime now = kStart;
  for (int i = 0; i < 200; ++i) {
    now = now + microseconds(random() % 400);
    const double gain = sut.judge(now, kStart, false).gain;
    ASSERT_LE(gain, previous);
    previous = gain;
  }
  EXPECT_EQ(previous, 0);
}

}  // namespace
}  // namespace thimble::servo
