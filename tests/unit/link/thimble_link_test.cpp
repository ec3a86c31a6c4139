#include <gtest/gtest.h>

#include <map>
#include <set>

#include "tests/unit/link/thimble_table.hpp"

namespace thimble::link {
namespace {

using on_table::Arm;
using on_table::Carried;
using on_table::keyed_arm;
using on_table::keyed_world;
using on_table::Table;
using std::chrono::milliseconds;

ImpairmentSettings delay_of(double delay_s, double jitter_s = 0) {
  return {.delay_s = delay_s, .jitter_s = jitter_s};
}
double ms_of(Duration time) { return 1e3 * thimble::seconds(time); }

TEST(ThimbleLink, FeelsAWallWithAndWithoutAKey) {
  for (const bool has_key : {false, true}) {
    Table table(has_key ? keyed_world() : ThimbleWorldEnd::Settings());
    Arm& arm = table.add_arm(has_key ? keyed_arm() : ThimbleArmEnd::Settings());
    table.run(100);
    ASSERT_GT(arm.replies.size(), 90U);
    EXPECT_EQ(arm.replies.back().planes.size(), 6U);
    EXPECT_EQ(arm.replies.back().planes[0].normal, (Direction3{1, 0, 0}));
    EXPECT_EQ(table.worlds.back()->samples.back().hand, arm.sample.hand);
    EXPECT_TRUE(arm.end.quality().is_up);
    EXPECT_EQ(table.world->sessions().size(), 1U);
    EXPECT_EQ(arm.end.status().counters.rejected(), 0U);
    EXPECT_EQ(table.world->total().rejected(), 0U);
  }
}

TEST(ThimbleLink, AReplyNamesTheSampleThatItAnswers) {
  Table table(keyed_world());
  ThimbleArmEnd::Settings settings = keyed_arm();
  settings.impairment = delay_of(0.04);
  Arm& arm = table.add_arm(settings);
  table.run(500);
  ASSERT_GT(arm.replies.size(), 300U);
  std::uint64_t before = 0;
  for (const coupling::ConstraintSet& reply : arm.replies) {
    EXPECT_EQ(reply.sampled_at, MonotonicTime{milliseconds(1000 + reply.answers)});
    EXPECT_GT(reply.answers, before);
    before = reply.answers;
  }
  EXPECT_EQ(arm.sample.sequence - before, 40U);  // the delay
  EXPECT_EQ(arm.end.status().counters.lost, 0U);
}

TEST(ThimbleLink, TellsRoundTripClocksAndWays) {
  Table table(keyed_world());
  ThimbleArmEnd::Settings settings = keyed_arm();
  settings.impairment = delay_of(0.1, 0.05);
  Arm& arm = table.add_arm(settings);
  table.run(3000);
  const LinkStatus status = arm.end.status();
  ASSERT_TRUE(status.clocks.has_value());
  EXPECT_NEAR(ms_of(status.clocks->offset - table.offset), 0, 2);
  EXPECT_LE(std::abs(ms_of(status.clocks->offset - table.offset)),
            ms_of(status.clocks->offset_error));
  EXPECT_NEAR(ms_of(status.round_trip), 100, 40);
  EXPECT_NEAR(ms_of(status.clocks->way_there), 50, 30);
  EXPECT_NEAR(ms_of(status.clocks->way_back), 50, 30);
  EXPECT_EQ(status.world, "box");
  const LinkStatus other = table.world->sessions().at(0);
  ASSERT_TRUE(other.clocks.has_value());
  EXPECT_NEAR(ms_of(other.clocks->offset + table.offset), 0, 2);
}

TEST(ThimbleLink, NeverStopsUnderEveryInjectedImpairment) {
  for (const SendMode mode : {SendMode::Streamed, SendMode::LockStep}) {
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      ThimbleWorldEnd::Settings world = keyed_world();
      world.impairment = {.loss = 0.1, .duplicate = 0.1, .reorder = 0.1, .seed = seed};
      Table table(world);
      ThimbleArmEnd::Settings settings = keyed_arm();
      settings.mode = mode;
      settings.impairment = {.delay_s = 0.02,
                             .jitter_s = 0.01,
                             .loss = 0.1,
                             .duplicate = 0.1,
                             .reorder = 0.1,
                             .seed = seed + 100};
      Arm& arm = table.add_arm(settings);
      table.run(4000);
      std::size_t before = arm.replies.size();
      std::uint64_t newest = 0;
      for (const coupling::ConstraintSet& reply : arm.replies) {
        EXPECT_GT(reply.answers, newest);
        newest = reply.answers;
      }
      table.run(1000);
      EXPECT_GT(arm.replies.size(), before + (mode == SendMode::Streamed ? 400U : 2U));
      const LinkCounters counters = arm.end.status().counters;
      EXPECT_EQ(counters.sessions_opened, 1U);
      EXPECT_GT(counters.duplicated, 0U);
      EXPECT_GT(counters.lost, 0U);
      EXPECT_EQ(counters.rejected(), 0U);
      EXPECT_EQ(table.worlds.size(), 1U);
    }
  }
}

TEST(ThimbleLink, ASampleThatWasOvertakenMovesNothing) {
  ThimbleWorldEnd::Settings world = keyed_world();
  world.impairment = {.duplicate = 0.2, .reorder = 0.2};
  Table table(world);
  table.add_arm(keyed_arm());
  table.run(2000);
  std::uint64_t newest = 0;
  for (const coupling::HandSample& sample : table.worlds.at(0)->samples) {
    EXPECT_GT(sample.sequence, newest);
    newest = sample.sequence;
  }
  const LinkCounters counters = table.world->total();
  EXPECT_GT(counters.duplicated, 100U);
  EXPECT_GT(counters.reordered, 100U);
  EXPECT_EQ(counters.stale, counters.duplicated + counters.reordered);
}

TEST(ThimbleLink, ADeadbandKeepsBackWhatTheWorldKnows) {
  Table table(keyed_world());
  ThimbleArmEnd::Settings settings = keyed_arm();
  settings.deadband_m = 0.0005;
  settings.impairment = delay_of(0.02);
  Arm& arm = table.add_arm(settings);
  for (int i = 0; i < 2000; ++i) {
    arm.sample.velocity.x = i < 1000 ? 0.1 : 0;
    arm.sample.hand.x += 1e-3 * arm.sample.velocity.x;
    table.step();
  }
  const LinkCounters counters = arm.end.status().counters;
  EXPECT_LT(counters.sent, 500U);  // every fifth or sixth
  EXPECT_NEAR(static_cast<double>(counters.sent + counters.withheld), 2000, 50);
  EXPECT_TRUE(arm.end.quality().is_up);
  EXPECT_NEAR(table.worlds[0]->samples.back().hand.x, arm.sample.hand.x, 0.0005);
}

TEST(ThimbleLink, LockStepHasOneSampleUnderWay) {
  Table table(keyed_world());
  ThimbleArmEnd::Settings settings = keyed_arm();
  settings.mode = SendMode::LockStep;
  settings.impairment = delay_of(0.02);
  Arm& arm = table.add_arm(settings);
  table.run(1100);
  EXPECT_NEAR(static_cast<double>(arm.replies.size()), 50, 5);
}

TEST(ThimbleLink, EachArmHasAWorldHalfOfItsOwn) {
  Table table(keyed_world());
  for (int i = 0; i < 3; ++i) {
    table.add_arm(keyed_arm()).sample.hand = {0.001 * i, 0, 0};
  }
  table.run(200);
  ASSERT_EQ(table.worlds.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(table.worlds[i]->samples.back().hand.x, 0.001 * static_cast<double>(i));
    EXPECT_GT(table.arms[i]->replies.size(), 190U);
  }
}

TEST(ThimbleLink, ASilentArmIsReleasedAndTheOthersFeelNothingOfIt) {
  Table table(keyed_world());
  Arm& stopped = table.add_arm(keyed_arm());
  Arm& other = table.add_arm(keyed_arm());
  table.run(100);
  stopped.is_running = false;
  const std::size_t before = other.replies.size();
  table.run(998);
  EXPECT_TRUE(table.worlds[0]->is_open);
  table.run(5);
  EXPECT_FALSE(table.worlds[0]->is_open);
  EXPECT_TRUE(table.worlds[1]->is_open);
  EXPECT_EQ(other.replies.size(), before + 1003);
  EXPECT_FALSE(stopped.end.quality().is_up);
  EXPECT_EQ(table.world->total().sessions_released, 1U);
}

TEST(ThimbleLink, ANinthArmIsRefusedUntilAPlaceIsFree) {
  Table table(keyed_world());
  for (int i = 0; i < 8; ++i) table.add_arm(keyed_arm());
  table.run(50);
  Arm& late = table.add_arm(keyed_arm());
  table.run(2500);
  EXPECT_EQ(table.worlds.size(), 8U);
  EXPECT_EQ(late.end.status().last_error, "the world holds as many hands as it can");
  EXPECT_GE(late.end.status().counters.rejected(RejectReason::SessionRefused), 2U);
  EXPECT_LE(late.end.status().counters.rejected(RejectReason::SessionRefused), 3U);
  table.arms[3]->is_running = false;
  table.run(2500);
  EXPECT_FALSE(late.replies.empty());
  EXPECT_EQ(late.end.status().last_error, "");
}

TEST(ThimbleLink, AnArmThatRestartedAtItsPortTakesItsPlaceAtOnce) {
  Table table(keyed_world());
  table.add_arm(keyed_arm());
  table.run(100);
  const Endpoint place = table.arms[0]->place;
  table.arms.clear();
  table.add_arm(keyed_arm()).place = place;
  table.run(20);
  ASSERT_EQ(table.worlds.size(), 2U);
  EXPECT_FALSE(table.worlds[0]->is_open);
  EXPECT_TRUE(table.worlds[1]->is_open);
}

TEST(ThimbleLink, AWorldThatRestartedIsANewSessionForTheArm) {
  Table table(keyed_world());
  Arm& arm = table.add_arm(keyed_arm());
  table.run(100);
  const std::uint32_t before = arm.replies.back().session;
  table.restart_world();
  table.run(900);
  const std::size_t heard = arm.replies.size();
  table.run(500);
  EXPECT_GT(arm.replies.size(), heard + 100);
  EXPECT_NE(arm.replies.back().session, before);
  EXPECT_EQ(arm.end.status().counters.sessions_opened, 2U);
}

TEST(ThimbleLink, AnArmHalfThatWasResetBeginsAnewInTheWorld) {
  Table table(keyed_world());
  ThimbleArmEnd::Settings settings = keyed_arm();
  settings.impairment = delay_of(0.05);
  Arm& arm = table.add_arm(settings);
  table.run(300);
  EXPECT_EQ(table.worlds[0]->opened, 1U);
  arm.sample.restart = 7;
  arm.sample.sequence = 0;  // it may count anew
  arm.replies.clear();
  table.run(200);
  EXPECT_EQ(table.worlds[0]->opened, 2U);
  EXPECT_EQ(table.worlds[0]->closed, 1U);
  ASSERT_FALSE(arm.replies.empty());
  EXPECT_EQ(arm.replies.front().answers, 1U);  // none of what was sent before
}

TEST(ThimbleLink, SaysWhyAWorldDoesNotGoWithItsScheme) {
  Table table(keyed_world());
  ThimbleArmEnd::Settings settings = keyed_arm();
  settings.half.scheme = ShortName::of("unheard-of");
  Arm& arm = table.add_arm(settings);
  table.run(3000);
  EXPECT_EQ(arm.end.status().last_error, "the world does not go with the scheme unheard-of");
  EXPECT_TRUE(table.worlds.empty());
  EXPECT_EQ(table.world->total().rejected(RejectReason::SessionRefused), 3U);
}

ThimbleWorldEnd::Settings waved_arm() {
  ThimbleWorldEnd::Settings settings = keyed_world();
  settings.arm_scheme = ShortName::of("wave");
  settings.welcome.world = ShortName::of("left");
  settings.max_sessions = 1;
  return settings;
}

TEST(ThimbleLink, AnArmAtTheFarEndSaysThatItIsOne) {
  Table table(waved_arm());
  Arm& arm = table.add_arm(keyed_arm());
  table.run(100);
  EXPECT_TRUE(arm.end.quality().is_up);
  EXPECT_EQ(arm.end.status().arm, "left");
  EXPECT_EQ(arm.end.status().world, "");
}

TEST(ThimbleLink, BothHearWhyTwoArmsDoNotGoTogether) {
  Table table(waved_arm());
  ThimbleArmEnd::Settings settings = keyed_arm();
  settings.half.scheme = ShortName::of("unheard-of");
  Arm& other = table.add_arm(settings);
  table.run(1500);
  EXPECT_EQ(other.end.status().last_error,
            "the far end is an arm of the scheme wave, which does not go with unheard-of");
  EXPECT_EQ(table.world->refusal(), "refused udp://127.0.0.1:40000: no such scheme");
  table.arms.clear();
  settings.half.scheme = ShortName::of("ghost-point");
  settings.mode = SendMode::LockStep;
  Arm& waiting = table.add_arm(settings);
  table.run(1500);
  EXPECT_EQ(waiting.end.status().last_error,
            "the far end is an arm, which follows a stream; this arm is in lock-step");
  table.arms.clear();
  table.add_arm(keyed_arm());
  table.run(1500);
  EXPECT_EQ(table.world->sessions().size(), 1U);
  EXPECT_EQ(table.world->refusal(), "") << "what came to nothing is over";
  Arm& third = table.add_arm(keyed_arm());
  table.run(100);
  EXPECT_EQ(third.end.status().last_error, "the world holds as many hands as it can");
  EXPECT_EQ(table.worlds.size(), 1U);
}

// What it does not know is neither said to it nor taken from it.
TEST(ThimbleLink, AnOlderArmIsRefusedByAnArmInItsOwnWords) {
  ThimbleWorldEnd::Settings settings = waved_arm();
  settings.key.reset();
  Table table(settings);
  const auto say = [&](const ThimbleHello& hello) {
    ThimbleDatagram datagram;
    ASSERT_TRUE(Seal().pack({.kind = ThimbleKind::Hello, .sequence = 1}, hello,
                            on_table::seeded_random(1), datagram));
    table.deliver(on_table::at_port(5), datagram.view());
  };
  const auto answer = [&](auto& message) {
    const auto bytes = table.carried.back().datagram.view();
    ASSERT_TRUE(decode(bytes.subspan(kThimbleHeaderSize), message));
  };
  ThimbleHello hello{.timing = {.sent_at = table.now()}, .arm_nonce = {std::byte{1}}};
  say(hello);
  ThimbleChallenge challenge;
  answer(challenge);
  hello.world_nonce = challenge.world_nonce;
  say(hello);
  ThimbleRefusal refusal;
  answer(refusal);
  EXPECT_EQ(refusal.reason, ThimbleRefusalReason::Scheme);
  EXPECT_EQ(table.world->refusal(),
            "refused udp://127.0.0.1:5: an older program, which cannot be coupled to an arm");
}

TEST(ThimbleLink, AWorldWithNothingToSayLooksSilentAndKeepsItsSession) {
  Table table(keyed_world());
  table.are_silent = true;
  Arm& arm = table.add_arm(keyed_arm());
  table.run(3000);
  EXPECT_TRUE(arm.replies.empty());
  EXPECT_FALSE(arm.end.quality().is_up);
  EXPECT_EQ(table.world->sessions().size(), 1U);
  EXPECT_EQ(arm.end.status().counters.sessions_opened, 1U);
  table.worlds[0]->is_silent = false;
  table.run(3);
  EXPECT_FALSE(arm.replies.empty());
}

TEST(ThimbleLink, AWorldThatRefusesTheHandIsAskedAgain) {
  Table table(keyed_world());
  table.refusals = 3;
  Arm& arm = table.add_arm(keyed_arm());
  table.run(200);
  EXPECT_TRUE(arm.replies.empty());
  EXPECT_EQ(table.worlds.at(0)->refusals, 1);
  table.run(200);
  EXPECT_FALSE(arm.replies.empty());
  EXPECT_EQ(table.worlds.size(), 1U);
}

TEST(ThimbleLink, TheSameSeedsGiveTheSameBytes) {
  const auto bytes = [] {
    ThimbleWorldEnd::Settings world = keyed_world();
    world.impairment = {.loss = 0.1, .reorder = 0.1};
    Table table(world);
    table.add_arm(keyed_arm());
    table.add_arm(keyed_arm());
    table.run(300);
    std::vector<std::byte> out;
    for (const Carried& datagram : table.carried) {
      out.insert(out.end(), datagram.datagram.view().begin(), datagram.datagram.view().end());
    }
    return out;
  };
  EXPECT_EQ(bytes(), bytes());
}

TEST(ThimbleLink, NoNumberOfASessionIsUsedTwice) {
  ThimbleWorldEnd::Settings world = keyed_world();
  world.impairment = {.loss = 0.3};
  Table table(world);
  table.add_arm(keyed_arm());
  table.add_arm(keyed_arm());
  table.run(3000);
  table.arms[0]->is_running = false;
  table.run(1500);
  table.arms[0]->is_running = true;
  table.run(500);
  std::set<std::tuple<bool, std::uint64_t, std::uint64_t>> seen;
  for (const Carried& datagram : table.carried) {
    const auto header = decode_header(datagram.datagram.view());
    if (header->session == 0) continue;
    EXPECT_TRUE(seen.insert({datagram.is_to_world, header->session, header->sequence}).second);
  }
  EXPECT_GT(seen.size(), 5000U);
}

}  // namespace
}  // namespace thimble::link
