#include "daemon/link/in_process_link.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "tests/unit/link/world_double.hpp"

namespace thimble::link {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

struct Arrival {
  MonotonicTime at{};
  coupling::ConstraintSet reply{};
};

// A servo of 1 kHz and a net plane, both in virtual time: pumped right after each tick and
// whenever the link asked for it.
class Bench {
 public:
  explicit Bench(const InProcessLink::Settings& settings = {}) : sut(settings, world) {}

  void run(Duration length, bool is_sending = true) {
    const MonotonicTime end = tick_ + length;
    for (; tick_ < end; tick_ = tick_ + milliseconds(1)) {
      while (due_ && *due_ < tick_) pump(*due_);
      if (is_sending) {
        sut.arm_end().send({.sequence = ++sequence,
                            .sampled_at = tick_,
                            .hand = {0.001, 0, 0},
                            .restart = restart});
      }
      pump(tick_);
    }
  }
  void pump(MonotonicTime now) {
    due_ = sut.pump(now);
    ASSERT_TRUE(!due_ || *due_ > now) << "asks to be pumped again at once";
    coupling::ConstraintSet reply;
    if (sut.arm_end().receive(reply)) arrivals.push_back({now, reply});
  }
  [[nodiscard]] MonotonicTime now() const { return tick_; }
  [[nodiscard]] LinkCounters counters() const { return sut.status().counters; }

  WorldDouble world;
  InProcessLink sut;
  std::vector<Arrival> arrivals;
  std::uint64_t sequence{0};
  std::uint32_t restart{0};

 private:
  MonotonicTime tick_{};
  std::optional<MonotonicTime> due_;
};

TEST(InProcessLink, AnswersEverySampleWithinTheSamePump) {
  Bench bench;
  bench.run(milliseconds(100));
  ASSERT_EQ(bench.arrivals.size(), 100U);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_EQ(bench.arrivals[i].reply.answers, i + 1);
    EXPECT_EQ(bench.arrivals[i].reply.sampled_at, bench.arrivals[i].at);
    EXPECT_EQ(bench.arrivals[i].reply.planes.size(), 6U);
  }
  const LinkStatus status = bench.sut.status();
  EXPECT_TRUE(status.is_up);
  EXPECT_EQ(status.round_trip, Duration::zero());
  EXPECT_EQ(status.counters.sent, 100U);
  EXPECT_EQ(status.counters.accepted, 100U);
  EXPECT_EQ(status.counters.lost, 0U);
  EXPECT_EQ(status.counters.sessions_opened, 1U);
}

TEST(InProcessLink, OpensTheSessionWithTheFirstSample) {
  Bench bench;
  bench.pump({});
  EXPECT_EQ(bench.world.opened, 0U);
  bench.run(milliseconds(1));
  ASSERT_EQ(bench.world.first_samples.size(), 1U);
  EXPECT_EQ(bench.world.first_samples[0].sequence, 1U);
  EXPECT_EQ(bench.world.answered_while_closed, 0U);
}

TEST(InProcessLink, AddsTheConfiguredDelayToTheRoundTrip) {
  Bench bench({.impairment = {.delay_s = 0.1}});
  bench.run(milliseconds(500));
  ASSERT_EQ(bench.arrivals.size(), 400U);
  for (const Arrival& arrival : bench.arrivals) {
    EXPECT_EQ(arrival.at - arrival.reply.sampled_at, milliseconds(100));
  }
  EXPECT_EQ(bench.sut.status().round_trip, milliseconds(100));
  EXPECT_EQ(bench.sut.arm_end().quality().round_trip, milliseconds(100));
  EXPECT_TRUE(bench.sut.arm_end().quality().is_up);
}

TEST(InProcessLink, TellsTheWorldTheTimeBetweenSamplesWithinBounds) {
  Bench bench;
  bench.run(milliseconds(3));
  bench.run(milliseconds(200), false);
  bench.run(milliseconds(1));
  ASSERT_EQ(bench.world.steps.size(), 4U);
  EXPECT_EQ(bench.world.steps[0], WorldSession::kMinStep);
  EXPECT_EQ(bench.world.steps[1], milliseconds(1));
  EXPECT_EQ(bench.world.steps[3], WorldSession::kMaxStep);
}

TEST(InProcessLink, ReleasesASilentArmAndOpensAgainOnItsReturn) {
  Bench bench;
  bench.run(milliseconds(10));
  bench.run(milliseconds(999), false);
  EXPECT_EQ(bench.world.closed, 0U);
  bench.run(milliseconds(2), false);
  EXPECT_EQ(bench.world.closed, 1U);
  EXPECT_FALSE(bench.sut.status().is_up);
  EXPECT_FALSE(bench.sut.arm_end().quality().is_up);
  EXPECT_EQ(bench.counters().sessions_released, 1U);
  bench.run(milliseconds(1));
  EXPECT_EQ(bench.world.opened, 2U);
  EXPECT_TRUE(bench.sut.status().is_up);
  EXPECT_EQ(bench.arrivals.back().reply.session, 2U);
}

TEST(InProcessLink, AWorldThatHasNothingNewToSayIsSilent) {
  Bench bench;
  bench.world.is_silent = true;
  bench.run(milliseconds(10));
  EXPECT_TRUE(bench.arrivals.empty()) << "a set without a number is none";
  bench.world.is_silent = false;
  bench.run(milliseconds(10));
  EXPECT_EQ(bench.arrivals.size(), 10U);
  bench.world.is_silent = true;
  bench.run(seconds(3));
  EXPECT_EQ(bench.arrivals.size(), 10U);
  EXPECT_FALSE(bench.sut.status().is_up);
  bench.world.is_silent = false;
  bench.run(milliseconds(10));
  EXPECT_EQ(bench.arrivals.size(), 20U);
}

TEST(InProcessLink, AsksToBePumpedWhenSilenceRunsOut) {
  WorldDouble world;
  InProcessLink sut({}, world);
  EXPECT_FALSE(sut.pump({}).has_value());
  sut.arm_end().send({.sequence = 1});
  const std::optional<MonotonicTime> due = sut.pump({milliseconds(5)});
  ASSERT_TRUE(due.has_value());
  EXPECT_EQ(due->since_epoch, milliseconds(1005));
  EXPECT_FALSE(sut.pump(*due).has_value());
  EXPECT_FALSE(world.is_open);
}

TEST(InProcessLink, ARestartOfTheArmOpensTheWorldAgainWithItsFirstSample) {
  Bench bench;
  bench.restart = 1;
  bench.run(milliseconds(10));
  EXPECT_EQ(bench.world.opened, 1U);
  bench.restart = 2;
  bench.run(milliseconds(10));
  EXPECT_EQ(bench.world.closed, 1U);
  ASSERT_EQ(bench.world.first_samples.size(), 2U);
  EXPECT_EQ(bench.world.first_samples[1].sequence, 11U);
  EXPECT_EQ(bench.arrivals.back().reply.session, 2U);
  EXPECT_EQ(bench.world.answered_while_closed, 0U);
}

TEST(InProcessLink, DropsRepliesOfTheSessionBeforeARestart) {
  Bench bench({.impairment = {.delay_s = 0.1}});
  bench.restart = 1;
  bench.run(milliseconds(200));
  const std::size_t before = bench.arrivals.size();
  bench.restart = 2;
  bench.run(milliseconds(200));
  ASSERT_GT(bench.arrivals.size(), before);
  for (std::size_t i = before; i < bench.arrivals.size(); ++i) {
    EXPECT_EQ(bench.arrivals[i].reply.session, 2U);
    EXPECT_GT(bench.arrivals[i].reply.answers, 200U);
  }
  EXPECT_EQ(bench.counters().stale, 100U);
  EXPECT_EQ(bench.counters().lost, 0U);
  EXPECT_TRUE(bench.sut.status().is_up);
}

TEST(InProcessLink, ReorderedSamplesFromBeforeARestartDoNotReachTheWorld) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Bench bench({.impairment = {.delay_s = 0.01, .jitter_s = 0.01, .reorder = 0.2, .seed = seed}});
    for (bench.restart = 1; bench.restart <= 5; ++bench.restart) bench.run(milliseconds(100));
    bench.run(milliseconds(100), false);
    EXPECT_EQ(bench.world.opened, 5U);
    std::uint32_t newest = 0;
    for (const coupling::HandSample& sample : bench.world.samples) {
      EXPECT_GE(sample.restart, newest);
      newest = sample.restart;
    }
  }
}

TEST(InProcessLink, LockStepGoesOnAcrossARestart) {
  Bench bench({.mode = SendMode::LockStep, .impairment = {.delay_s = 0.01}});
  bench.restart = 1;
  bench.run(milliseconds(100));
  bench.restart = 2;
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.arrivals.back().reply.session, 2U);
  EXPECT_EQ(bench.counters().timed_out, 0U);
}

TEST(InProcessLink, ClosesTheSessionWithItself) {
  WorldDouble world;
  {
    InProcessLink sut({}, world);
    sut.arm_end().send({.sequence = 1});
    sut.pump({});
    EXPECT_TRUE(world.is_open);
  }
  EXPECT_FALSE(world.is_open);
  EXPECT_EQ(world.closed, 1U);
}

TEST(InProcessLink, AsksAgainAfterAPauseWhenTheWorldRefusesTheHand) {
  Bench bench;
  bench.world.refusals = 3;
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.world.refusals, 2) << "asked once, not with every sample";
  bench.run(milliseconds(200));
  EXPECT_EQ(bench.world.opened, 0U);
  bench.run(milliseconds(7));
  EXPECT_EQ(bench.world.opened, 1U);
  EXPECT_EQ(bench.arrivals.size(), 7U);
  EXPECT_EQ(bench.counters().rejected(RejectReason::SessionRefused), 3U);
  EXPECT_NE(bench.sut.status().last_error.find("as many hands"), std::string::npos);
}

TEST(InProcessLink, KeepsNonFiniteHandsFromTheWorld) {
  Bench bench;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  bench.sut.arm_end().send({.sequence = 1, .hand = {0, nan, 0}});
  bench.pump({});
  bench.sut.arm_end().send({.sequence = 2, .hand = {}, .velocity = {inf, 0, 0}});
  bench.pump({});
  EXPECT_EQ(bench.world.opened, 0U);
  EXPECT_EQ(bench.counters().rejected(RejectReason::NonFinite), 2U);
  EXPECT_EQ(bench.counters().rejected(), 2U);
}

TEST(InProcessLink, CountsEverySampleAsLostWhenNothingComesThrough) {
  Bench bench({.impairment = {.loss = 1}});
  bench.run(seconds(1));
  EXPECT_EQ(bench.counters().lost, 0U) << "a reply may still come";
  bench.run(seconds(2));
  EXPECT_GE(bench.counters().lost, 1000U);
  EXPECT_LE(bench.counters().lost, 2000U);
  bench.run(seconds(3), false);
  EXPECT_EQ(bench.counters().sent, 3000U);
  EXPECT_EQ(bench.counters().lost, 3000U);
}

TEST(InProcessLink, ARepliedSampleIsNoLossHoweverLate) {
  Bench bench({.impairment = {.delay_s = 1.5}});
  bench.run(seconds(4));
  EXPECT_GT(bench.arrivals.size(), 2000U);
  bench.run(seconds(3), false);
  EXPECT_EQ(bench.counters().accepted, 4000U);
  EXPECT_EQ(bench.counters().lost, 0U);
}

TEST(InProcessLink, CountsLossDuplicationAndReorderingExactly) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Bench bench({.impairment = {.delay_s = 0.01,
                                .jitter_s = 0.01,
                                .loss = 0.1,
                                .duplicate = 0.1,
                                .reorder = 0.1,
                                .seed = seed}});
    bench.run(seconds(2));
    bench.run(milliseconds(100), false);
    const LinkCounters counters = bench.counters();
    EXPECT_EQ(counters.sent, 2000U);
    EXPECT_EQ(counters.received, counters.accepted + counters.stale);
    EXPECT_EQ(counters.stale, counters.duplicated + counters.reordered);
    // Every sample is accepted, overtaken or lost; the tail may hide losses behind it.
    EXPECT_NEAR(static_cast<double>(counters.accepted + counters.reordered + counters.lost), 2000,
                5);
    EXPECT_GT(counters.lost, 200U);
    EXPECT_GT(counters.duplicated, 100U);
    EXPECT_GT(counters.reordered, 100U);
    EXPECT_GT(counters.injected.lost, 300U);
    std::uint64_t newest = 0;  // the servo never sees an older answer after a newer one
    for (const Arrival& arrival : bench.arrivals) {
      EXPECT_GT(arrival.reply.answers, newest);
      newest = arrival.reply.answers;
    }
    EXPECT_TRUE(bench.sut.status().is_up);
  }
}

TEST(InProcessLink, SurvivesAServoThatCountsFromOneAgain) {
  Bench bench;
  bench.run(milliseconds(50));
  bench.sequence = 0;
  bench.run(milliseconds(50));
  EXPECT_EQ(bench.arrivals.size(), 100U);
  EXPECT_EQ(bench.counters().stale, 0U);
}

TEST(InProcessLink, LockStepSendsOneSampleARoundTrip) {
  Bench bench({.mode = SendMode::LockStep, .impairment = {.delay_s = 0.05}});
  bench.run(seconds(1));
  const LinkCounters counters = bench.counters();
  EXPECT_EQ(counters.timed_out, 0U);
  EXPECT_GE(counters.sent, 19U);
  EXPECT_LE(counters.sent, 20U);
  for (std::size_t i = 1; i < bench.arrivals.size(); ++i) {  // the newest hand, not a queued one
    EXPECT_LE(bench.arrivals[i].at - bench.arrivals[i].reply.sampled_at, milliseconds(51));
  }
}

// teleop.md 7 row 8. The servo here applies a reply in the tick after it arrived.
TEST(InProcessLink, InLockStepNoSampleLeavesThatWasMadeBeforeTheLastReplyWasInForce) {
  for (const double delay_s : {0.0, 0.0105, 0.02}) {
    WorldDouble world;
    InProcessLink sut({.mode = SendMode::LockStep, .impairment = {.delay_s = delay_s}}, world);
    std::uint64_t applied = 0;
    std::optional<MonotonicTime> due;
    std::uint64_t sent = 0;
    for (MonotonicTime tick{}; tick < MonotonicTime{seconds(1)}; tick = tick + milliseconds(1)) {
      while (due && *due <= tick) due = sut.pump(*due);
      coupling::ConstraintSet reply;
      if (sut.arm_end().receive(reply)) applied = reply.answers;
      sut.arm_end().send({.sequence = ++sent, .sampled_at = tick, .applied_reply = applied});
      due = sut.pump(tick);
    }
    ASSERT_GT(world.samples.size(), 40U);
    for (std::size_t i = 1; i < world.samples.size(); ++i) {
      ASSERT_EQ(world.samples[i].applied_reply, world.samples[i - 1].sequence) << delay_s;
    }
  }
}

TEST(InProcessLink, LockStepNeverDeadlocksUnderLoss) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    Bench bench({.mode = SendMode::LockStep,
                 .impairment = {.delay_s = 0.004, .loss = 0.3, .duplicate = 0.1, .seed = seed}});
    bench.run(seconds(10));
    EXPECT_GT(bench.counters().timed_out, 10U);
    EXPECT_GT(bench.counters().accepted, 60U);
    bench.run(seconds(10));
    EXPECT_GT(bench.counters().accepted, 120U);
  }
}

TEST(InProcessLink, LockStepLearnsARoundTripLongerThanItsTimeout) {
  Bench bench({.mode = SendMode::LockStep, .impairment = {.delay_s = 0.8}});
  bench.run(seconds(10));
  const std::uint64_t timed_out = bench.counters().timed_out;
  EXPECT_LE(timed_out, 5U);
  bench.run(seconds(10));
  EXPECT_EQ(bench.counters().timed_out, timed_out);
  EXPECT_EQ(bench.sut.status().round_trip, milliseconds(800));
}

TEST(InProcessLink, TheSameSeedGivesTheSameRun) {
  const auto run = [](std::uint64_t seed) {
    Bench bench({.impairment = {.delay_s = 0.02, .jitter_s = 0.02, .loss = 0.1, .seed = seed}});
    bench.run(seconds(1));
    std::vector<std::pair<std::int64_t, std::uint64_t>> trace;
    for (const Arrival& a : bench.arrivals) {
      trace.emplace_back(a.at.since_epoch.count(), a.reply.answers);
    }
    return trace;
  };
  EXPECT_EQ(run(4), run(4));
  EXPECT_NE(run(4), run(5));
}

}  // namespace
}  // namespace thimble::link
