#include "daemon/app/repeated_warnings.hpp"

#include <gtest/gtest.h>

#include <random>

namespace thimble::app {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class RepeatedWarningsTest : public testing::Test {
 protected:
  // What the log says of `warning`, `after` the one before; empty: nothing.
  std::string say(const std::string& warning, Duration after = {}) {
    now_ = now_ + after;
    return sut_.admit(warning, now_).value_or("");
  }
  RepeatedWarnings sut_;
  MonotonicTime now_{};
};

TEST_F(RepeatedWarningsTest, SaysTheFirstAtOnceAndThenOnceAMinuteWithACount) {
  EXPECT_EQ(say("busy"), "busy");
  int said = 0;
  for (int i = 1; i < 30; ++i) said += say("busy", seconds(2)).empty() ? 0 : 1;
  EXPECT_EQ(said, 0);
  EXPECT_EQ(say("busy", seconds(2)), "busy (and 29 times more)");
  for (int i = 1; i < 30; ++i) EXPECT_EQ(say("busy", seconds(2)), "");
  EXPECT_EQ(say("busy", seconds(2)), "busy (and 29 times more)");
}

TEST_F(RepeatedWarningsTest, HoldsNoOtherWarningBack) {
  EXPECT_EQ(say("left is busy"), "left is busy");
  EXPECT_EQ(say("right is busy"), "right is busy");
  EXPECT_EQ(say("left is busy"), "");
}

TEST_F(RepeatedWarningsTest, IsNewsAgainAfterAPause) {
  EXPECT_EQ(say("busy"), "busy");
  EXPECT_EQ(say("busy", RepeatedWarnings::kForgotten - milliseconds(1)), "");
  EXPECT_EQ(say("busy", RepeatedWarnings::kForgotten), "busy");
}

// Any mixture: of one warning no more is said than the first of each pause and one a minute.
TEST_F(RepeatedWarningsTest, NeverFloodsWhateverComes) {
  std::mt19937 random(4);
  std::map<std::string, MonotonicTime> said_at;
  for (int round = 0; round < 50'000; ++round) {
    const std::string warning = "w" + std::to_string(random() % 8);
    const std::string line = say(warning, milliseconds(random() % 400));
    if (line.empty()) continue;
    const auto before = said_at.find(warning);
    if (before != said_at.end()) {
      ASSERT_GE(now_ - before->second, RepeatedWarnings::kForgotten);
    }
    said_at[warning] = now_;
  }
}

TEST_F(RepeatedWarningsTest, ForgetsTheStalestOfTooMany) {
  const auto name = [](std::size_t i) { return "w" + std::to_string(i); };
  for (std::size_t i = 0; i < RepeatedWarnings::kMost; ++i) say(name(i), milliseconds(1));
  EXPECT_EQ(say(name(0), milliseconds(1)), "") << "now the freshest";
  EXPECT_EQ(say("one too many", milliseconds(1)), "one too many");
  EXPECT_EQ(say(name(0), milliseconds(1)), "");
  EXPECT_EQ(say(name(1), milliseconds(1)), name(1)) << "it was the stalest";
}

}  // namespace
}  // namespace thimble::app
