#include "sim/export/verb.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>

namespace thimble::sim {
namespace {

TEST(Verb, IsAWordAndItsNumbers) {
  EXPECT_EQ(*parse_verb("move 0.01 -0.02 3e-3 0.5"),
            (Verb{VerbKind::Move, {0.01, -0.02, 0.003, 0.5}}));
  EXPECT_EQ(*parse_verb("  press\t1 \r"), (Verb{VerbKind::Press, {1}}));
  EXPECT_EQ(*parse_verb("unplug"), Verb{VerbKind::Unplug});
  EXPECT_EQ(*parse_verb("pull-cable"), Verb{VerbKind::PullCable});
  EXPECT_EQ(*parse_verb("stall 0.25"), (Verb{VerbKind::Stall, {0.25}}));
  EXPECT_EQ(*parse_verb("short-out 50"), (Verb{VerbKind::ShortOut, {50}}));
  EXPECT_EQ(*parse_verb("halt 2"), (Verb{VerbKind::Halt, {2}}));
  EXPECT_EQ(*parse_verb("felt 3 0.25"), (Verb{VerbKind::Felt, {3, 0.25}}));
  EXPECT_EQ(*parse_verb("fault lost-echo 700"), (Verb{VerbKind::Fault, {700}, "lost-echo"}));
}

TEST(Verb, HasUsualNumbersForThoseThatMayBeLeftOut) {
  EXPECT_EQ(parse_verb("move 0 0 0")->numbers[3], 1);
  EXPECT_EQ(parse_verb("home")->numbers[0], 1);
  EXPECT_EQ(parse_verb("corrupt")->numbers[0], 1);
  EXPECT_EQ(parse_verb("log")->numbers[0], 1);
  EXPECT_EQ(*parse_verb("fault deaf"), (Verb{VerbKind::Fault, {1}, "deaf"}));
}

TEST(Verb, RefusesWhatItCannotBe) {
  for (const char* line : {"",
                           " ",
                           "jump",
                           "move",
                           "move 0 0",
                           "move 0 0 0 1 1",
                           "move a 0 0",
                           "move nan 0 0",
                           "move inf 0 0",
                           "move 2 0 0",
                           "move 0 0 0 0",
                           "move 0 0 0 1e9",
                           "press",
                           "press 1.5",
                           "press -1",
                           "press 32",
                           "press 1 2",
                           "unplug 1",
                           "status now",
                           "stall -1",
                           "stall 1e9",
                           "corrupt 1e7",
                           "push 1 2",
                           "push 1000 0 0",
                           "MOVE 0 0 0",
                           "move 0x1 0 0",
                           "fault",
                           "fault deaf 0.5",
                           "fault deaf 1 2",
                           "short-out -1",
                           "halt 0.5",
                           "felt 1 -1",
                           "felt 1 1 1",
                           "home 0"}) {
    const auto verb = parse_verb(line);
    ASSERT_FALSE(verb) << line;
    EXPECT_EQ(verb.error().code, Errc::InvalidArgument) << line;
    EXPECT_FALSE(verb.error().message.empty());
  }
  EXPECT_FALSE(parse_verb(std::string(kMaxVerbBytes + 1, ' ')));
}

// tests/fuzz has no other word to begin with.
TEST(Verb, HasASeedForItsFuzzer) {
  const std::string words = parse_verb("jump").error().message;
  std::istringstream all(words.substr(words.find("are:") + 4));
  std::size_t count = 0;
  for (std::string word; all >> word; ++count) {
    std::ifstream seed(std::filesystem::path(THIMBLE_SOURCE_DIR) / "tests/data/corpus/simdev_verb" /
                       word);
    std::string line;
    ASSERT_TRUE(std::getline(seed, line)) << word;
    EXPECT_TRUE(parse_verb(line)) << line;
    EXPECT_EQ(line.substr(0, line.find(' ')), word);
  }
  EXPECT_EQ(count, 20U);
}

TEST(Verb, NamesThoseThereAreForOneThatIsUnknown) {
  const std::string words = parse_verb("jump").error().message;
  for (const char* word : {"move", "press", "unplug", "log"}) {
    EXPECT_NE(words.find(word), std::string::npos) << word;
  }
}

TEST(Verb, TakesAnyBytes) {
  std::mt19937 random(5);
  for (int i = 0; i < 20000; ++i) {
    std::string line = i % 2 == 0 ? "move " : "";
    for (std::size_t left = random() % 40; left > 0; --left) line += static_cast<char>(random());
    const auto verb = parse_verb(line);
    if (verb) continue;
    EXPECT_LT(verb.error().message.size(), 400U);
  }
}

}  // namespace
}  // namespace thimble::sim
