#include "tests/campaign/shrink.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace thimble::campaign {
namespace {

using std::chrono::milliseconds;

// Breaks at the end of the last of the kinds it needs, when all of them are there; plays nothing.
struct Oracle {
  std::vector<EventKind> needed;
  bool needs_lock_step{false};
  int plays{0};

  std::optional<Breach> operator()(const Programme& programme) {
    ++plays;
    Duration at{};
    for (const EventKind kind : needed) {
      const auto found = std::find_if(programme.events.begin(), programme.events.end(),
                                      [kind](const Event& event) { return event.kind == kind; });
      if (found == programme.events.end()) return std::nullopt;
      at = std::max(at, found->at);
    }
    if (needs_lock_step && !programme.setup.is_lock_step) return std::nullopt;
    const auto tick = static_cast<std::uint64_t>(at / milliseconds(1)) + 1;
    if (tick > programme.ticks) return std::nullopt;
    return Breach{"planted", 1, 0, tick, MonotonicTime{at}};
  }
};

Programme some_programme() {
  Programme programme = draw(1, 0);
  for (std::uint64_t episode = 1; programme.events.size() < 60; ++episode) {
    programme = draw(1, episode);
  }
  programme.ticks = 100'000'000;
  return programme;
}

TEST(Shrink, FindsTheEventsThatMatter) {
  const std::vector<std::vector<EventKind>> cases{
      {EventKind::Clear}, {EventKind::Clear, EventKind::Unplug}, {}};
  for (const std::vector<EventKind>& needed : cases) {
    Programme programme = some_programme();
    for (const EventKind kind : needed) programme.events.push_back({kind, milliseconds(9000)});
    Oracle oracle{needed};
    const auto shrunk = shrink(programme, [&](const Programme& one) { return oracle(one); });
    ASSERT_TRUE(shrunk.has_value());
    EXPECT_EQ(shrunk->programme.events.size(), needed.size());
    EXPECT_EQ(shrunk->programme.ticks, shrunk->breach.tick) << "not a tick more than it needs";
    EXPECT_EQ(shrunk->plays, static_cast<std::uint64_t>(oracle.plays));
    EXPECT_EQ(shrunk->programme.setup, campaign::Setup{}) << "the configuration does not matter";
  }
}

TEST(Shrink, KeepsTheSettingThatMatters) {
  Programme programme = some_programme();
  programme.setup.is_lock_step = true;
  Oracle oracle{{EventKind::Clear}, true};
  const auto shrunk = shrink(programme, [&](const Programme& one) { return oracle(one); });
  ASSERT_TRUE(shrunk.has_value());
  campaign::Setup expected;
  expected.is_lock_step = true;
  EXPECT_EQ(shrunk->programme.setup, expected);
}

TEST(Shrink, PutsEverySettingBackThatDoesNotMatter) {
  Programme programme = some_programme();
  campaign::Setup& setup = programme.setup;
  setup.world = "volume";
  setup.world_seed = 7;
  setup.materials = 2;
  setup.cells = 5;
  setup.is_edited = setup.is_hostile = setup.has_bystander = true;
  setup.is_simple_model = setup.is_thesis_literal = setup.is_lock_step = true;
  setup.noise.delay_out = setup.noise.truncate_out = 0.01;
  Oracle oracle{{EventKind::Clear}};
  const auto shrunk = shrink(programme, [&](const Programme& one) { return oracle(one); });
  ASSERT_TRUE(shrunk.has_value());
  EXPECT_EQ(shrunk->programme.setup, campaign::Setup{});
}

TEST(Shrink, IsNotLedAstrayByAnotherRule) {
  Programme programme = some_programme();
  programme.events.push_back({EventKind::Estop, milliseconds(9000)});
  const auto play = [](const Programme& one) -> std::optional<Breach> {
    const bool is_estop = std::any_of(one.events.begin(), one.events.end(), [](const Event& event) {
      return event.kind == EventKind::Estop;
    });
    return Breach{is_estop ? "first" : "second", 1, 0, one.ticks,
                  MonotonicTime{milliseconds(9000)}};
  };
  const auto shrunk = shrink(programme, play);
  ASSERT_TRUE(shrunk.has_value());
  EXPECT_EQ(shrunk->breach.rule, "first");
  EXPECT_EQ(shrunk->programme.events.size(), 1U);
}

TEST(Shrink, SaysWhenNothingBreaks) {
  const auto never = [](const Programme&) { return std::optional<Breach>(); };
  EXPECT_FALSE(shrink(some_programme(), never).has_value());
}

TEST(Shrink, StopsAfterAsManyPlaysAsItMay) {
  Programme programme = some_programme();
  Oracle oracle{{EventKind::Clear}};
  const auto shrunk = shrink(
      programme, [&](const Programme& one) { return oracle(one); }, 5);
  ASSERT_TRUE(shrunk.has_value());
  EXPECT_LE(oracle.plays, 6);
}

}  // namespace
}  // namespace thimble::campaign
