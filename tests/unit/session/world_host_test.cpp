#include "daemon/session/world_host.hpp"

#include <gtest/gtest.h>

#include <random>

namespace thimble::session {
namespace {

using std::chrono::microseconds;

constexpr std::int32_t kCells = 512;

// A world in which a fill of everything takes many slices.
std::unique_ptr<WorldHost> large_world() {
  config::WorldConfig said;
  said.name = "large";
  said.source = "box:512";
  const plugin::SimModelRegistry models;
  const plugin::DriverRegistry drivers;
  return WorldHost::create(said, {.models = models, .drivers = drivers}).value();
}

world::CellEdit everything(std::uint8_t value) {
  return {world::CellEdit::Kind::Fill, {}, {kCells - 1, kCells - 1, kCells - 1}, {}, 0, value};
}

// A client that asks all the time, or a fast servo, wakes the net plane without end.
TEST(WorldHost, SlicesOfEditsKeepTheirPaceHoweverOftenItIsPumped) {
  std::mt19937 random(3);
  const auto sut = large_world();
  ASSERT_TRUE(sut->submit_edits({everything(0), everything(1)}));
  std::size_t before = sut->world().occupied_cells();
  MonotonicTime now{};
  MonotonicTime last_slice{-WorldHost::kEditPace};
  int slices = 0;
  for (int pump = 0; pump < 2000; ++pump) {
    const auto due = sut->pump(now);
    if (sut->world().occupied_cells() != before) {
      EXPECT_GE(now - last_slice, WorldHost::kEditPace);
      last_slice = now;
      before = sut->world().occupied_cells();
      ++slices;
    }
    ASSERT_TRUE(due);
    EXPECT_GT(*due, now);
    EXPECT_LE(*due, now + WorldHost::kEditPace);
    now = random() % 8 == 0 ? *due : now + microseconds(random() % 150);
  }
  EXPECT_GT(slices, 100);
}

TEST(WorldHost, AnEditAfterARestIsAppliedAtOnceAndEndsThePace) {
  const auto sut = large_world();
  EXPECT_FALSE(sut->pump({}));
  const MonotonicTime later{std::chrono::seconds(5)};
  ASSERT_TRUE(sut->submit_edits({{world::CellEdit::Kind::Fill, {}, {}, {}, 0, 0}}));
  EXPECT_FALSE(sut->pump(later)) << "nothing is left to come back for";
  EXPECT_EQ(sut->edits()->applied(), 1U);
}

}  // namespace
}  // namespace thimble::session
