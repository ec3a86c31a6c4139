#include <gtest/gtest.h>

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

}  // namespace
}  // namespace thimble::link
