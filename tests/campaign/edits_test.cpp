#include "tests/campaign/edits.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <set>

#include "tests/campaign/dice.hpp"
#include "tests/campaign/episode.hpp"
#include "tests/support/closed_loop.hpp"

namespace thimble::campaign {
namespace {

using std::chrono::milliseconds;

constexpr std::array kKinds{EventKind::EditFill, EventKind::EditClear, EventKind::EditBox,
                            EventKind::EditPaint, EventKind::EditAll};

TEST(Edits, AreGoodWhereverTheHandIs) {
  Dice dice(3);
  for (const char* source : {"world.source=box:3", "world.source=box:9"}) {
    test::ClosedLoop loop({source});
    const world::VoxelWorld& world = *loop.world().editable();
    std::set<std::size_t> sizes;
    for (int i = 0; i < 5000; ++i) {
      Event event{kKinds[dice.below(kKinds.size())]};
      event.cell = dice.bits();
      const double reach_m = i % 3 == 0 ? 1e9 : 0.05;
      const Position3 hand{dice.uniform(-reach_m, reach_m), dice.uniform(-reach_m, reach_m), 0};
      const world::CellEdit edit = edit_of(event, world, hand);
      const bool is_far_brush = edit.kind == world::CellEdit::Kind::Paint && reach_m > 1;
      ASSERT_TRUE(is_far_brush || check_edit(world, edit).has_value())
          << to_string(event.kind) << ' ' << check_edit(world, edit).error().message;
      ASSERT_EQ(edit_of(event, world, hand), edit) << "the same each time";
      sizes.insert(static_cast<std::size_t>(edit.last.x - edit.first.x));
    }
    EXPECT_GE(sizes.size(), 3U);
  }
}

TEST(Edits, FillTheLastFreeCellAndGiveItBack) {
  test::ClosedLoop loop;
  Edits sut(*loop.runtime().worlds().front());
  const Event all{EventKind::EditAll};
  sut.begin(all, {});
  EXPECT_EQ(sut.waiting(), 1U);
  EXPECT_FALSE(sut.has_applied());
  loop.run(0.01);
  EXPECT_EQ(sut.waiting(), 0U);
  EXPECT_TRUE(sut.has_applied());
  EXPECT_FALSE(sut.has_applied()) << "since the last call";
  EXPECT_EQ(loop.world().occupied_cells(), all_cells(loop.world()));
  sut.end(all);
  loop.run(0.01);
  EXPECT_EQ(loop.world().occupied_cells(), 26U) << "the box stands again";
  EXPECT_EQ(sut.applied(), 3U);
}

// While the network hears nothing, edits wait; too many are refused, which is no defect.
TEST(Edits, AreRefusedWhereTooManyWait) {
  test::ClosedLoop loop;
  Edits sut(*loop.runtime().worlds().front());
  std::array<Event, 100> events{};
  for (Event& event : events) {
    event.kind = EventKind::EditFill;
    EXPECT_NO_THROW(sut.begin(event, {}));
  }
  EXPECT_LT(sut.waiting(), events.size());
}

// Whoever edits, the person's arm goes on: a world without room lets go of the hand, and has it
// again.
TEST(Episode, AWorldThatIsFilledAgainAndAgainBreaksNoRule) {
  Programme programme;
  programme.seed = 1;
  programme.ticks = 20'000;
  programme.setup.hand_reach_m = 0.03;
  Dice dice(5);
  for (int i = 0; i < 100; ++i) {
    Event event{kKinds[dice.below(kKinds.size())], milliseconds(1800 + 180 * i),
                milliseconds(20 + dice.below(300))};
    event.cell = dice.bits();
    programme.events.push_back(event);
  }
  const Ending ending = play(programme);
  EXPECT_FALSE(ending.breach.has_value()) << to_text(*ending.breach);
  EXPECT_GT(ending.tally.edits, 200U);
  EXPECT_GT(ending.tally.contacts, 20U);
  EXPECT_EQ(ending.tally.ticks_in[static_cast<std::size_t>(OperatingState::Fault)], 0U);
}

}  // namespace
}  // namespace thimble::campaign
