#include <gtest/gtest.h>

#include "tests/unit/link/thimble_table.hpp"

// How a session of our own protocol begins where the way is long: what is said first in it is a
// whole round trip on its way.
namespace thimble::link {
namespace {

using on_table::Arm;
using on_table::keyed_arm;
using on_table::keyed_world;
using on_table::Table;

ThimbleArmEnd::Settings delayed_arm(double delay_s, SendMode mode = SendMode::Streamed) {
  ThimbleArmEnd::Settings settings = keyed_arm();
  settings.mode = mode;
  settings.impairment.delay_s = delay_s;
  return settings;
}

void expect_one_session(double delay_s, SendMode mode) {
  SCOPED_TRACE(delay_s);
  Table table(keyed_world());
  Arm& arm = table.add_arm(delayed_arm(delay_s, mode));
  table.run(10000);
  EXPECT_FALSE(arm.replies.empty());
  EXPECT_TRUE(arm.end.quality().is_up);
  EXPECT_EQ(arm.end.status().counters.sessions_opened, 1U);
  EXPECT_EQ(arm.end.status().counters.sessions_released, 0U);
  EXPECT_EQ(table.world->total().sessions_released, 0U);
}

TEST(ThimbleBegin, AStreamTakesTheLongestDelayThatIsOffered) {
  for (const double delay_s : {0.9, 1.0, 1.5, ImpairmentSettings::kMaxDelay_s}) {
    expect_one_session(delay_s, SendMode::Streamed);
  }
}

// Each sample of it is a round trip after the last, and a second of silence is an end.
TEST(ThimbleBegin, LockStepTakesADelayOfLessThanASecond) {
  for (const double delay_s : {0.5, 0.9}) expect_one_session(delay_s, SendMode::LockStep);
}

TEST(ThimbleBegin, AnArmThatIsGoneBeforeItsFirstSampleIsForgotten) {
  Table table(keyed_world());
  table.add_arm(delayed_arm(0.4));
  while (table.world->sessions().empty()) table.step();
  table.arms.clear();
  table.run(4900);
  EXPECT_EQ(table.world->sessions().size(), 1U);
  table.run(200);
  EXPECT_TRUE(table.world->sessions().empty());
  EXPECT_EQ(table.world->total().sessions_released, 1U);
}

TEST(ThimbleBegin, ThePlaceOfOneThatIsGoneIsANewcomersAfterASecond) {
  ThimbleWorldEnd::Settings settings = keyed_world();
  settings.max_sessions = 1;
  Table table(settings);
  table.add_arm(delayed_arm(0.4));
  while (table.world->sessions().empty()) table.step();
  table.arms.clear();
  Arm& newcomer = table.add_arm(keyed_arm());
  table.run(900);
  EXPECT_TRUE(newcomer.replies.empty());
  table.run(1500);  // it is refused meanwhile, and asks again each second
  EXPECT_FALSE(newcomer.replies.empty());
}

TEST(ThimbleBegin, AWorldThatIsGoneBeforeItsFirstReplyIsAskedAnew) {
  Table table(keyed_world());
  Arm& arm = table.add_arm(delayed_arm(0.4));
  while (arm.end.status().counters.sessions_opened == 0) table.step();
  table.restart_world();
  table.run(4900);
  EXPECT_EQ(arm.end.status().counters.sessions_released, 0U);
  table.run(3000);
  EXPECT_EQ(arm.end.status().counters.sessions_released, 1U);
  EXPECT_EQ(arm.end.status().counters.sessions_opened, 2U);
  EXPECT_TRUE(arm.end.quality().is_up);
}

TEST(ThimbleBegin, OnceItHasBegunASecondOfSilenceEndsItAtBothEnds) {
  Table table(keyed_world());
  Arm& arm = table.add_arm(delayed_arm(0.4));
  table.run(3000);
  ASSERT_FALSE(arm.replies.empty());
  arm.is_running = false;
  table.run(1900);
  EXPECT_TRUE(table.world->sessions().empty());
  EXPECT_EQ(arm.end.status().counters.sessions_released, 1U);
}

}  // namespace
}  // namespace thimble::link
