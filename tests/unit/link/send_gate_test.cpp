#include "daemon/link/send_gate.hpp"

#include <gtest/gtest.h>

#include <random>

#include "daemon/link/round_trip.hpp"
#include "daemon/link/sequence_window.hpp"

namespace thimble::link {
namespace {

using std::chrono::milliseconds;

MonotonicTime ms(int value) { return {milliseconds(value)}; }

TEST(SendGate, StreamedIsAlwaysOpen) {
  SendGate sut(SendMode::Streamed);
  for (int i = 0; i < 5; ++i) {
    EXPECT_TRUE(sut.may_send(ms(0)));
    sut.on_sent(ms(0), {});
  }
  EXPECT_FALSE(sut.deadline().has_value());
  EXPECT_EQ(sut.timed_out(), 0U);
}

TEST(SendGate, LockStepOpensOnTheReply) {
  SendGate sut(SendMode::LockStep);
  sut.on_sent(ms(0), milliseconds(1));
  EXPECT_FALSE(sut.may_send(ms(5)));
  sut.on_reply(ms(5));
  EXPECT_TRUE(sut.may_send(ms(5)));
  EXPECT_FALSE(sut.deadline().has_value());
}

TEST(SendGate, WaitsThreeRoundTripsButAtLeastTwentyMilliseconds) {
  SendGate sut(SendMode::LockStep);
  sut.on_sent(ms(0), milliseconds(1));
  EXPECT_FALSE(sut.may_send(ms(19)));
  EXPECT_TRUE(sut.may_send(ms(20)));
  sut.on_answered();
  sut.on_sent(ms(100), milliseconds(50));
  EXPECT_EQ(sut.deadline()->since_epoch, milliseconds(250));
  sut.on_answered();
  sut.on_sent(ms(300), {});
  EXPECT_EQ(sut.deadline()->since_epoch, milliseconds(550));
}

TEST(SendGate, BacksOffWhileNothingAnswersButKeepsAsking) {
  SendGate sut(SendMode::LockStep);
  MonotonicTime now = ms(0);
  sut.on_sent(now, milliseconds(1));
  for (int i = 0; i < 20; ++i) {
    const Duration wait = *sut.deadline() - now;
    EXPECT_LE(wait, SendGate::kMaxTimeout);
    now = *sut.deadline();
    ASSERT_TRUE(sut.may_send(now));
    sut.on_sent(now, milliseconds(1));
  }
  EXPECT_EQ(sut.timed_out(), 20U);
  EXPECT_EQ(*sut.deadline() - now, SendGate::kMaxTimeout);
  sut.on_answered();
  sut.on_sent(now, milliseconds(1));
  EXPECT_EQ(*sut.deadline() - now, SendGate::kMinTimeout);
}

TEST(SendGate, DrainsTheLinkAfterATimeoutBeforeItTrustsAReply) {
  SendGate sut(SendMode::LockStep);
  sut.on_sent(ms(0), milliseconds(1));
  sut.on_sent(ms(20), milliseconds(1));  // the first is overdue
  EXPECT_TRUE(sut.is_ambiguous());
  sut.on_reply(ms(25));  // to the first or to the second?
  EXPECT_FALSE(sut.may_send(ms(26)));
  sut.on_reply(ms(30));  // the other one: the silence starts anew
  EXPECT_FALSE(sut.may_send(ms(109)));
  EXPECT_TRUE(sut.may_send(ms(110)));
  sut.on_sent(ms(110), milliseconds(1));
  EXPECT_FALSE(sut.is_ambiguous());
  EXPECT_EQ(sut.timed_out(), 1U);
  sut.on_reply(ms(111));
  EXPECT_TRUE(sut.may_send(ms(111)));
}

TEST(RoundTrip, ConvergesOnTheMeanAndItsDeviation) {
  RoundTrip sut;
  EXPECT_EQ(sut.smoothed(), Duration::zero());
  for (int i = 0; i < 200; ++i) sut.note(milliseconds(i % 2 == 0 ? 9 : 11));
  EXPECT_NEAR(seconds(sut.smoothed()), 0.010, 2e-4);
  EXPECT_NEAR(seconds(sut.deviation()), 0.001, 2e-4);
  sut.reset();
  sut.note(milliseconds(-5));
  EXPECT_EQ(sut.smoothed(), Duration::zero());
}

TEST(SequenceWindow, AgreesWithASetOfSeenNumbers) {
  std::mt19937 random(11);
  SequenceWindow sut;
  std::vector<bool> seen(5000, false);
  std::uint64_t newest = 0;
  for (int step = 0; step < 20000; ++step) {
    const std::uint64_t jump = random() % 80;
    const std::uint64_t base = newest > 70 ? newest - 70 : 1;
    const std::uint64_t number = std::min<std::uint64_t>(base + jump, 4999);
    const SequenceWindow::Outcome outcome = sut.note(number);
    if (number > newest) {
      EXPECT_EQ(outcome.verdict, SequenceWindow::Verdict::Newest);
      EXPECT_EQ(outcome.skipped, number - newest - 1);
      newest = number;
    } else if (newest - number < 64 && seen[number]) {
      EXPECT_EQ(outcome.verdict, SequenceWindow::Verdict::Duplicate);
    } else {
      EXPECT_EQ(outcome.verdict, SequenceWindow::Verdict::Overtaken);
    }
    seen[number] = true;
  }
  EXPECT_EQ(newest, 4999U);
}

}  // namespace
}  // namespace thimble::link
