// What both ends agree upon when a session begins: the scheme, the cells, and what the world does.
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "tests/unit/link/thimble_table.hpp"

namespace thimble::link {
namespace {

using on_table::Arm;
using on_table::Carried;
using on_table::keyed_arm;
using on_table::keyed_world;
using on_table::Table;

ThimbleArmEnd::Settings with_two_choices() {
  ThimbleArmEnd::Settings settings = keyed_arm();
  settings.half.scheme = ShortName::of("composite");
  settings.else_half = ThimbleHalf{.scheme = ShortName::of("ghost-point")};
  return settings;
}

TEST(ThimbleLink, TellsWhetherItsWorldHearsActions) {
  for (const bool is_heard : {false, true}) {
    ThimbleWorldEnd::Settings world = keyed_world();
    if (is_heard) world.welcome.capabilities = kHearsActions;
    Table table(world);
    Arm& arm = table.add_arm(keyed_arm());
    EXPECT_FALSE(arm.end.status().hears_actions) << "nobody has said so yet";
    table.run(100);
    EXPECT_EQ(arm.end.status().hears_actions, is_heard);
    EXPECT_EQ(arm.end.status().arm, "") << "it is a world all the same";
  }
}

TEST(ThimbleLink, AsksForItsSecondChoiceAtOnceWhereTheWorldHasNotTheFirst) {
  Table table(keyed_world());
  Arm& arm = table.add_arm(with_two_choices());
  EXPECT_EQ(arm.end.status().scheme, "");
  table.run(20);
  EXPECT_EQ(arm.end.status().scheme, "composite");
  EXPECT_EQ(arm.end.status().scheme_reason, "the world goes with it");
  table.unheard_of = "composite";
  table.restart_world();
  table.run(1030);
  EXPECT_EQ(arm.end.status().scheme, "ghost-point");
  EXPECT_EQ(arm.end.status().scheme_reason, "the world does not go with composite");
  EXPECT_EQ(arm.end.status().last_error, "");
  EXPECT_EQ(table.world->sessions().at(0).scheme, "ghost-point");
  table.unheard_of = "unheard-of";
  table.restart_world();
  table.run(1030);
  EXPECT_EQ(arm.end.status().scheme, "composite") << "each session begins with the first choice";
}

TEST(ThimbleLink, AWorldThatHasNeitherChoiceIsAskedOnceASecond) {
  Table table(keyed_world());
  ThimbleArmEnd::Settings settings = with_two_choices();
  settings.half.scheme = settings.else_half->scheme = ShortName::of("unheard-of");
  Arm& arm = table.add_arm(settings);
  table.run(3000);
  EXPECT_EQ(arm.end.status().scheme, "");
  EXPECT_EQ(arm.end.status().last_error, "the world does not go with the scheme unheard-of");
  EXPECT_EQ(table.world->total().rejected(RejectReason::SessionRefused), 6U);
}

// Worlds of either kind come and go on bad networks: whoever has a session has the best that the
// world of now goes with, and both ends say the same.
TEST(ThimbleLink, BothEndsAlwaysHaveTheSameScheme) {
  int sessions = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    std::mt19937_64 random(seed);
    ThimbleWorldEnd::Settings world = keyed_world();
    world.impairment = {.loss = 0.1, .duplicate = 0.1, .reorder = 0.1, .seed = seed};
    Table table(world);
    ThimbleArmEnd::Settings settings = with_two_choices();
    settings.impairment = {.delay_s = 0.02 * static_cast<double>(seed % 4),
                           .jitter_s = 0.01,
                           .loss = 0.1,
                           .seed = seed};
    Arm& arm = table.add_arm(settings);
    for (int world_of = 0; world_of < 4; ++world_of) {
      table.unheard_of = random() % 2 == 0 ? "composite" : "unheard-of";
      table.restart_world();
      table.run(2500 + static_cast<int>(random() % 500));
      ASSERT_EQ(table.world->sessions().size(), 1U);
      const std::string scheme = table.world->sessions()[0].scheme;
      EXPECT_EQ(arm.end.status().scheme, scheme);
      EXPECT_EQ(scheme, table.unheard_of == "composite" ? "ghost-point" : "composite");
      EXPECT_TRUE(arm.end.quality().is_up);
      ++sessions;
    }
  }
  EXPECT_EQ(sessions, 16);
}

TEST(ThimbleLink, AWelcomeTellsTheEpochOfTheCellsOfTheHalfThatWasMade) {
  Table table;
  table.add_arm();
  table.run(10);
  int welcomes = 0;
  for (const Carried& one : table.carried) {
    const auto bytes = one.datagram.view();
    if (decode_header(bytes)->kind != ThimbleKind::Welcome) continue;
    ThimbleWelcome welcome;
    ASSERT_TRUE(decode(bytes.subspan(kThimbleHeaderSize), welcome));
    EXPECT_EQ(welcome.epoch, 77U);
    ++welcomes;
  }
  EXPECT_EQ(welcomes, 1);
}

}  // namespace
}  // namespace thimble::link
