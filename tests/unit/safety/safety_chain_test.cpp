#include "daemon/safety/safety_chain.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <string>

#include "tests/unit/safety/safety_bench.hpp"

namespace thimble::safety {
namespace {

using std::chrono::milliseconds;

struct SafetyChainTest : testing::Test, SafetyBench {};

TEST_F(SafetyChainTest, IsStoppedFromTheStartAndGoesOnOnlyWhenAsked) {
  run(milliseconds(500));
  expect_stopped(ChainTrouble::None);
  EXPECT_EQ(chain.status().trouble, ChainTrouble::None);
  EXPECT_EQ(chip.changes(3), 0U);
  EXPECT_TRUE(chain.reset());
  EXPECT_FALSE(step().is_stopped);
}

TEST_F(SafetyChainTest, APressStopsInTheSameStepAndReleaseDoesNotResume) {
  ASSERT_TRUE(start());
  press(true);
  EXPECT_TRUE(step().is_stopped);
  expect_stopped(ChainTrouble::Open);
  EXPECT_FALSE(chain.reset());
  press(false);
  run(milliseconds(500));
  EXPECT_TRUE(chain.status().is_stopped);
  EXPECT_EQ(chain.status().trouble, ChainTrouble::None);
  EXPECT_TRUE(chain.reset());
  EXPECT_FALSE(step().is_stopped);
  EXPECT_EQ(chain.status().stops, 1U);
}

TEST_F(SafetyChainTest, APulseBetweenTwoStepsStops) {
  ASSERT_TRUE(start());
  chip.set_level(1, true);
  chip.set_level(1, false);
  EXPECT_TRUE(step().is_stopped);
  expect_stopped(ChainTrouble::Open);
}

TEST_F(SafetyChainTest, AContactThatBouncesIsOneStop) {
  ASSERT_TRUE(start());
  for (const bool is_pressed : {true, false}) {
    chip.bounce(0, is_pressed, 7);
    chip.bounce(1, is_pressed, 4);
    run(milliseconds(100));
  }
  EXPECT_EQ(chain.status().stops, 1U);
  EXPECT_TRUE(chain.reset());
}

TEST_F(SafetyChainTest, AStuckChannelIsADefectThatTheButtonDoesNotMend) {
  ASSERT_TRUE(start());
  chip.stick(1, true);
  press(true);
  run(milliseconds(100));
  expect_stopped(ChainTrouble::Open);
  press(false);
  run(milliseconds(100));
  EXPECT_EQ(chain.status().trouble, ChainTrouble::Disagree);
  EXPECT_FALSE(chain.reset());
  chip.stick(1, false);
  EXPECT_FALSE(chain.reset()) << "it has to be seen open, too";
  press(true);
  run(milliseconds(20));
  press(false);
  run(milliseconds(20));
  EXPECT_TRUE(chain.reset());
}

TEST_F(SafetyChainTest, ALostChipStopsAndItsReturnDoesNotResume) {
  ASSERT_TRUE(start());
  chip.lose();
  EXPECT_TRUE(step().is_stopped);
  expect_stopped(ChainTrouble::NoLines);
  lines.reset();
  run(milliseconds(100));
  EXPECT_FALSE(chain.reset());
  chip.restore();
  lines = open();
  chain.restart_lines();
  run(milliseconds(100));
  EXPECT_TRUE(chain.status().is_stopped);
  EXPECT_TRUE(chain.reset());
  EXPECT_GT(beats_within(milliseconds(100)), 3U);
}

TEST_F(SafetyChainTest, ALostLineStops) {
  ASSERT_TRUE(start());
  chip.lose_line(1);
  step();
  expect_stopped(ChainTrouble::NoLines);
}

TEST_F(SafetyChainTest, ALostEdgeStopsBeItOnlyTheDeadmans) {
  ASSERT_TRUE(start());
  chip.set_level(2, true);
  chip.lose_edges(1);
  chip.set_level(2, false);
  chip.set_level(2, true);
  step();
  expect_stopped(ChainTrouble::EdgesLost);
}

TEST_F(SafetyChainTest, AChipThatAnswersNothingStopsBeforeTheRelayFalls) {
  ASSERT_TRUE(start());
  run(milliseconds(100));
  chip.hang(true);
  run(kEnableHalfPeriod);
  EXPECT_FALSE(chain.status().is_stopped);
  run(kEnableGap);
  EXPECT_TRUE(chain.status().is_stopped);
  run(kSilence);
  EXPECT_EQ(chain.status().trouble, ChainTrouble::Silent);
  chip.hang(false);
  run(milliseconds(100));
  EXPECT_EQ(chain.status().trouble, ChainTrouble::None);
  EXPECT_TRUE(chain.reset());
}

TEST_F(SafetyChainTest, TheLampIsLitWhileForceIsPossibleAndBlinksWhileAPersonIsAwaited) {
  std::set<bool> seen;
  for (int i = 0; i < 300; ++i) {
    step();
    seen.insert(chip.level(4));
  }
  EXPECT_EQ(seen, (std::set<bool>{false, true})) << "it blinks";
  ASSERT_TRUE(start());
  run(milliseconds(50));
  for (int i = 0; i < 300; ++i) {
    step();
    ASSERT_TRUE(chip.level(4));
  }
  press(true);
  run(milliseconds(50));
  for (int i = 0; i < 300; ++i) {
    step();
    ASSERT_FALSE(chip.level(4));
  }
}

TEST_F(SafetyChainTest, AClosedContactMayBeHighAsWell) {
  SafetyChain sut({.estop_channels = 1, .is_closed_high = true});
  const auto own = chip.open({"bench", {"5"}, {}}, nullptr).value();
  sut.step(own.get(), clock.now(), [] { return true; });
  EXPECT_EQ(sut.status().trouble, ChainTrouble::Open);
  chip.set_level(5, true);
  for (int i = 0; i < 2; ++i) sut.step(own.get(), clock.now(), [] { return true; });
  EXPECT_EQ(sut.status().trouble, ChainTrouble::None);
}

TEST_F(SafetyChainTest, AStopFromWithoutNeedsAPersonToo) {
  ASSERT_TRUE(start());
  chain.stop(ChainTrouble::Unwatched);
  run(milliseconds(100));
  expect_stopped(ChainTrouble::Unwatched);
  EXPECT_TRUE(chain.reset());
}

TEST_F(SafetyChainTest, AStopThatIsHeldIsLetGoByNobodyBeforeItsTime) {
  ASSERT_TRUE(start());
  chain.hold(ChainTrouble::ArmOutOfReach, clock.now() + milliseconds(1000));
  expect_stopped(ChainTrouble::ArmOutOfReach);
  for (int i = 0; i < 9; ++i) {
    EXPECT_LE(beats_within(milliseconds(100)), 1U) << "low, and no more";
    EXPECT_EQ(chain.status().trouble, ChainTrouble::ArmOutOfReach);
    EXPECT_FALSE(chain.reset());
  }
  run(milliseconds(200));
  expect_stopped(ChainTrouble::ArmOutOfReach);
  EXPECT_EQ(chain.status().trouble, ChainTrouble::None) << "a person is awaited";
  EXPECT_TRUE(chain.reset());
  EXPECT_GT(beats_within(milliseconds(200)), 5U);
}

TEST(ChainTrouble, EachHasAWordAndASentence) {
  std::set<std::string> words;
  for (int i = 0; i < kChainTroubleCount; ++i) {
    const auto sut = static_cast<ChainTrouble>(i);
    words.insert(std::string(to_string(sut)));
    EXPECT_EQ(explain(sut).empty(), sut == ChainTrouble::None);
    EXPECT_EQ(recall(sut).empty(), sut == ChainTrouble::None);
  }
  EXPECT_EQ(words.size(), static_cast<std::size_t>(kChainTroubleCount));
  EXPECT_FALSE(words.contains("unknown"));
}

}  // namespace
}  // namespace thimble::safety
