#include <gtest/gtest.h>

#include <vector>

#include "tests/unit/link/thimble_table.hpp"

// Who has a place in a world's end, and when another one may have it.
namespace thimble::link {
namespace {

using on_table::Arm;
using on_table::keyed_arm;
using on_table::keyed_world;
using on_table::Table;

// What it says keeps its session, not its place: an arm that listens has one.
TEST(ThimblePlaces, AnArmWhoseHandIsNotTakenMakesRoomForOneThatNeedsIt) {
  ThimbleWorldEnd::Settings settings = keyed_world();
  settings.max_sessions = 1;
  Table table(settings);
  table.refusals = 1 << 20;
  Arm& outside = table.add_arm(keyed_arm());
  table.run(3000);
  EXPECT_EQ(table.worlds.size(), 1U) << "nobody else is there";
  table.refusals = 0;
  Arm& late = table.add_arm(keyed_arm());
  table.run(1500);
  EXPECT_GT(late.replies.size(), 100U);
  EXPECT_TRUE(outside.replies.empty());
  table.run(3000);
  EXPECT_TRUE(table.worlds.back()->is_open) << "who is in the world keeps its place";
  EXPECT_EQ(table.worlds.size(), 2U);
}

TEST(ThimblePlaces, NobodyLosesAPlaceToWhoIsRefused) {
  ThimbleWorldEnd::Settings settings = keyed_world();
  settings.max_sessions = 1;
  Table table(settings);
  table.refusals = 1 << 20;
  table.add_arm(keyed_arm());
  table.run(3000);
  ThimbleArmEnd::Settings other = keyed_arm();
  other.half.scheme = ShortName::of("unheard-of");
  table.add_arm(other);
  table.run(3000);
  EXPECT_EQ(table.worlds.size(), 1U);
  EXPECT_EQ(table.world->total().sessions_released, 0U);
  EXPECT_EQ(table.world->sessions().size(), 1U);
}

TEST(ThimblePlaces, AnArmThatIsTakenAtTheLastMomentKeepsItsPlace) {
  ThimbleWorldEnd::Settings settings = keyed_world();
  settings.max_sessions = 1;
  Table table(settings);
  table.refusals = 9;  // one each 100 ms
  Arm& first = table.add_arm(keyed_arm());
  table.run(5);
  table.add_arm(keyed_arm());
  table.run(3000);
  EXPECT_EQ(table.worlds.size(), 1U);
  EXPECT_GT(first.replies.size(), 1900U);
}

// At 10 Hz a peer is slow, but not silent (kSilence).
TEST(ThimblePlaces, AnArmAtTenHertzKeepsItsSessionAndOneBesideItNoticesNothing) {
  const auto replies_of_fast = [](bool has_slow, Table& table) {
    Arm& fast = table.add_arm(keyed_arm());
    Arm* const slow = has_slow ? &table.add_arm(keyed_arm()) : nullptr;
    table.run(100);
    if (slow != nullptr) slow->is_running = false;
    for (int i = 0; i < 3000; ++i) {
      if (slow != nullptr) slow->is_running = i % 100 == 0;
      fast.sample.hand.x = 0.016 + 1e-6 * i;
      table.step();
    }
    return fast.replies;
  };
  Table alone(keyed_world());
  Table together(keyed_world());
  const std::vector<coupling::ConstraintSet> expected = replies_of_fast(false, alone);
  const std::vector<coupling::ConstraintSet> found = replies_of_fast(true, together);
  ASSERT_EQ(found.size(), expected.size());
  EXPECT_GT(found.size(), 3090U);
  for (std::size_t i = 0; i < found.size(); ++i) {
    ASSERT_EQ(found[i].sequence, expected[i].sequence);
    ASSERT_EQ(found[i].answers, expected[i].answers);
    ASSERT_EQ(found[i].sampled_at, expected[i].sampled_at);
    ASSERT_EQ(found[i].planes, expected[i].planes);
  }
  EXPECT_EQ(together.worlds.at(0)->samples.back().hand, together.arms.at(0)->sample.hand);
  EXPECT_EQ(together.arms.at(0)->end.status().counters.lost, 0U);
  Arm& slow = *together.arms.at(1);
  EXPECT_NEAR(static_cast<double>(slow.replies.size()), 130, 5);
  EXPECT_EQ(slow.replies.back().answers, slow.sample.sequence);
  EXPECT_EQ(slow.end.status().counters.sessions_opened, 1U);
  EXPECT_EQ(slow.end.status().counters.lost, 0U);
  EXPECT_EQ(together.world->total().sessions_released, 0U);
  EXPECT_EQ(together.worlds.size(), 2U);
}

}  // namespace
}  // namespace thimble::link
