#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/unit/config/config_testing.hpp"

namespace thimble::config {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

std::string world_of(const std::string& source, const std::string& lines) {
  return "[[world]]\nname = \"w\"\nsource = \"" + source + "\"\n" + lines;
}

TEST(ConfigAutomaton, NeedsNothingButItsName) {
  for (const char* source : {"life", "crystal"}) {
    const auto sut = parse_text(world_of(source, ""));
    ASSERT_TRUE(sut);
    EXPECT_EQ(sut->worlds.at(0).source, source);
    EXPECT_EQ(sut->worlds.at(0).automaton, AutomatonConfig{});
  }
  EXPECT_EQ(parse_text(world_of("crystal", "automaton.axes = 3\n"))->worlds.at(0).automaton->cells,
            64);
}

TEST(ConfigAutomaton, ReadsEveryKey) {
  const auto sut =
      parse_text(world_of("crystal",
                          "[world.automaton]\naxes = 3\ncells = 32\nseed = 9\nfill_fraction = "
                          "0.25\nsteps_per_s = 100\npoke_cells = 1.5\n"));
  ASSERT_TRUE(sut);
  const AutomatonConfig expected{3, 32, 9, 0.25, 100, 1.5};
  EXPECT_EQ(sut->worlds.at(0).automaton, expected);
}

TEST(ConfigAutomaton, ItsTableBesideAnotherSourceIsAMistake) {
  EXPECT_THAT(mistakes(world_of("box:3", "[world.automaton]\n")),
              ElementsAre(AllOf(HasSubstr("world.0.automaton"), HasSubstr("\"box:3\""))));
  EXPECT_FALSE(parse_text(world_of("box:3", ""))->worlds.at(0).automaton);
}

struct BadAutomaton {
  const char* source;
  const char* lines;
  const char* expected;
};

class ConfigAutomatonMistake : public testing::TestWithParam<BadAutomaton> {};
INSTANTIATE_TEST_SUITE_P(
    ConfigAutomaton, ConfigAutomatonMistake,
    testing::Values(BadAutomaton{"life", "automaton.axes = 3\n", "only a crystal"},
                    BadAutomaton{"life", "automaton.cells = 100\n", "power of two"},
                    BadAutomaton{"crystal", "automaton.axes = 3\nautomaton.cells = 128\n", "64"},
                    BadAutomaton{"life", "automaton.cells = 16\n", "32"},
                    BadAutomaton{"life", "automaton.fill_fraction = 1.5\n", "fill_fraction"},
                    BadAutomaton{"life", "automaton.steps_per_s = -1\n", "steps_per_s"},
                    BadAutomaton{"life", "automaton.poke_cells = 0\n", "poke_cells"},
                    BadAutomaton{"crystal", "threshold = 2\n", "only with a volume file"},
                    BadAutomaton{"crystal", "automaton.colour = 2\n", "colour"}));

TEST_P(ConfigAutomatonMistake, IsNamed) {
  EXPECT_THAT(mistakes(world_of(GetParam().source, GetParam().lines)),
              ElementsAre(HasSubstr(GetParam().expected)));
}

}  // namespace
}  // namespace thimble::config
