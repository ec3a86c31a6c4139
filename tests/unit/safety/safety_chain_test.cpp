#include "daemon/safety/safety_chain.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "hal/bus/gpio_mailboxes.hpp"
#include "tests/unit/safety/safety_bench.hpp"

namespace thimble::safety {
namespace {

using std::chrono::milliseconds;

struct SafetyChainTest : testing::Test, SafetyBench {
  void expect_stopped(ChainTrouble cause) const {
    EXPECT_TRUE(chain.status().is_stopped);
    EXPECT_EQ(chain.status().cause, cause) << to_string(chain.status().cause);
    EXPECT_FALSE(chain.status().is_enable_beating);
  }
  // Edges of the enable line within so long.
  std::uint64_t beats_within(Duration duration) {
    const std::uint64_t before = chip.changes(3);
    run(duration);
    return chip.changes(3) - before;
  }
};

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

TEST_F(SafetyChainTest, AChipThatAnswersNothingStopsWithinItsSilence) {
  ASSERT_TRUE(start());
  run(milliseconds(100));
  chip.hang(true);
  run(kSilence);
  EXPECT_FALSE(chain.status().is_stopped);
  run(milliseconds(10));
  EXPECT_TRUE(chain.status().is_stopped);
  chip.hang(false);
  run(milliseconds(100));
  EXPECT_EQ(chain.status().trouble, ChainTrouble::None);
  EXPECT_TRUE(chain.reset());
}

// An adapter that reads its inputs and takes no output: nobody could cut the power by it.
class DeafLines final : public bus::GpioLines {
 public:
  DeafLines(bus::GpioLines& lines, const bool& is_deaf) : lines_(lines), is_deaf_(is_deaf) {}
  IoStatus next_edge(bus::GpioEdge& out) noexcept override { return lines_.next_edge(out); }
  IoStatus levels(bus::GpioLevels& out) noexcept override { return lines_.levels(out); }
  IoStatus set(std::size_t output, bool is_high) noexcept override {
    return is_deaf_ ? IoStatus::Backlogged : lines_.set(output, is_high);
  }

 private:
  bus::GpioLines& lines_;
  const bool& is_deaf_;
};

TEST_F(SafetyChainTest, OutputsThatStayBackloggedStopWithinTheSilence) {
  bool is_deaf = false;
  const std::unique_ptr<bus::GpioLines> below = std::exchange(lines, nullptr);
  lines = std::make_unique<DeafLines>(*below, is_deaf);
  ASSERT_TRUE(start());
  run(milliseconds(200));
  is_deaf = true;
  run(kSilence);
  EXPECT_FALSE(chain.status().is_stopped);
  run(kEnableHalfPeriod + kStep);
  EXPECT_EQ(chain.status().trouble, ChainTrouble::OutputStuck);
  expect_stopped(ChainTrouble::OutputStuck);
  EXPECT_FALSE(chain.reset()) << "as long as it takes nothing";
  is_deaf = false;
  run(milliseconds(100));
  EXPECT_EQ(chain.status().trouble, ChainTrouble::None);
  expect_stopped(ChainTrouble::OutputStuck);
  EXPECT_TRUE(chain.reset());
  EXPECT_GT(beats_within(milliseconds(100)), 3U);
}

TEST_F(SafetyChainTest, OutputsThatAreBackloggedNowAndThenAreNoStop) {
  bool is_deaf = false;
  const std::unique_ptr<bus::GpioLines> below = std::exchange(lines, nullptr);
  lines = std::make_unique<DeafLines>(*below, is_deaf);
  ASSERT_TRUE(start());
  for (int i = 0; i < 20; ++i) {
    is_deaf = i % 2 == 0;
    run(kSilence / 2);
    ASSERT_FALSE(chain.status().is_stopped) << i;
  }
}

// The bus of a real chip: it reads the inputs, of outputs it takes those that the test says.
struct SafetyChainOnMailboxes : testing::Test {
  MonotonicTime now{std::chrono::seconds(1)};
  bus::GpioMailboxes mail{1, 2, nullptr};
  SafetyChain chain{{.estop_channels = 1, .has_enable = true, .has_lamp = true}};

  void step() {
    now = now + SafetyBench::kStep;
    mail.deliver_levels({0, now});
    chain.step(&mail, now, [] { return true; });
  }
  void run(Duration duration) {
    for (Duration run{}; run < duration; run += SafetyBench::kStep) step();
  }
  void take() {
    if (const auto wish = mail.wanted()) mail.written(*wish);
  }
  void start() {
    for (int i = 0; i < 100; ++i) {
      step();
      take();
    }
    ASSERT_TRUE(chain.reset());
  }
};

TEST_F(SafetyChainOnMailboxes, ABeatThatNoneTakesIsStuckThoughItsLevelComesBack) {
  start();
  run(kSilence);
  EXPECT_FALSE(chain.status().is_stopped);
  run(2 * kEnableHalfPeriod + SafetyBench::kStep);
  EXPECT_EQ(chain.status().trouble, ChainTrouble::OutputStuck);
  EXPECT_EQ(chain.status().cause, ChainTrouble::OutputStuck);
  EXPECT_FALSE(chain.status().is_enable_beating);
  run(milliseconds(1000));
  EXPECT_FALSE(chain.reset()) << "as long as it takes nothing";
  take();
  run(2 * kEnableHalfPeriod);
  EXPECT_TRUE(chain.reset());
}

TEST_F(SafetyChainOnMailboxes, BeatsThatAreTakenLateAreNoStop) {
  start();
  std::optional<bus::GpioWish> wish;
  for (int i = 0; i < 400; ++i) {
    step();
    if (i % 5 != 0) continue;  // a chip that is busy for 25 ms with each
    if (wish) mail.written(*wish);
    wish = mail.wanted();
    ASSERT_FALSE(chain.status().is_stopped) << i;
  }
}

TEST_F(SafetyChainTest, EnableBeatsAtTwentyFiveHertzWhileTheServosDo) {
  ASSERT_TRUE(start());
  EXPECT_EQ(beats_within(milliseconds(1000)), 50U);
  EXPECT_TRUE(chain.status().is_enable_beating);
  is_servo_beating = false;
  EXPECT_EQ(beats_within(milliseconds(1000)), 0U);
  EXPECT_FALSE(chain.status().is_enable_beating);
  EXPECT_FALSE(chain.status().is_stopped) << "the servo's own watchdogs judge the servo";
  is_servo_beating = true;
  EXPECT_EQ(beats_within(milliseconds(1000)), 50U);
}

TEST_F(SafetyChainTest, EnableStopsWithTheStop) {
  ASSERT_TRUE(start());
  run(milliseconds(500));
  press(true);
  step();
  EXPECT_LE(beats_within(milliseconds(1000)), 1U) << "to low, where it was high";
  EXPECT_FALSE(chip.level(3));
  press(false);
  EXPECT_EQ(beats_within(milliseconds(1000)), 0U);
}

TEST_F(SafetyChainTest, EnableIsLowWhenTheLinesAreClosed) {
  ASSERT_TRUE(start());
  while (!chip.level(3)) step();
  lines.reset();
  EXPECT_FALSE(chip.level(3));
}

TEST_F(SafetyChainTest, TheServosAreAskedOncePerBeat) {
  ASSERT_TRUE(start());
  asked = 0;
  run(milliseconds(1000));
  EXPECT_EQ(asked, 50);
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
