#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <utility>

#include "daemon/safety/safety_chain.hpp"
#include "hal/bus/gpio_mailboxes.hpp"
#include "tests/unit/safety/safety_bench.hpp"

// The enable line: who lets it beat, who stops it, and that it does not come back by itself.
namespace thimble::safety {
namespace {

using std::chrono::milliseconds;

struct EnableLine : testing::Test, SafetyBench {};

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

TEST_F(EnableLine, OutputsThatStayBackloggedStopBeforeTheRelayFalls) {
  bool is_deaf = false;
  const std::unique_ptr<bus::GpioLines> below = std::exchange(lines, nullptr);
  lines = std::make_unique<DeafLines>(*below, is_deaf);
  ASSERT_TRUE(start());
  run(milliseconds(200));
  is_deaf = true;
  run(kEnableHalfPeriod);
  EXPECT_FALSE(chain.status().is_stopped);
  run(kEnableGap);
  expect_stopped(ChainTrouble::OutputStuck);
  run(kEnableHalfPeriod + 2 * kStep);
  for (int i = 0; i < 100; ++i, step()) {
    ASSERT_EQ(chain.status().trouble, ChainTrouble::OutputStuck) << i;
  }
  EXPECT_FALSE(chain.reset()) << "as long as it takes nothing";
  is_deaf = false;
  run(milliseconds(100));
  EXPECT_EQ(chain.status().trouble, ChainTrouble::None);
  expect_stopped(ChainTrouble::OutputStuck);
  EXPECT_TRUE(chain.reset());
  EXPECT_GT(beats_within(milliseconds(100)), 3U);
}

TEST_F(EnableLine, OutputsThatAreBackloggedNowAndThenAreNoStop) {
  bool is_deaf = false;
  const std::unique_ptr<bus::GpioLines> below = std::exchange(lines, nullptr);
  lines = std::make_unique<DeafLines>(*below, is_deaf);
  ASSERT_TRUE(start());
  for (int i = 0; i < 100; ++i) {
    is_deaf = i % 2 == 0;
    run(milliseconds(10));
    ASSERT_FALSE(chain.status().is_stopped) << i;
  }
}

// The bus of a real chip: it reads the inputs, of outputs it takes those that the test says.
struct EnableOnMailboxes : testing::Test {
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

TEST_F(EnableOnMailboxes, ABeatThatNoneTakesIsStuckThoughItsLevelComesBack) {
  start();
  run(kEnableHalfPeriod);
  EXPECT_FALSE(chain.status().is_stopped);
  run(kSilence + 3 * kEnableHalfPeriod);
  EXPECT_EQ(chain.status().trouble, ChainTrouble::OutputStuck);
  EXPECT_EQ(chain.status().cause, ChainTrouble::OutputStuck);
  EXPECT_FALSE(chain.status().is_enable_beating);
  run(milliseconds(1000));
  EXPECT_FALSE(chain.reset()) << "as long as it takes nothing";
  take();
  run(2 * kEnableHalfPeriod);
  EXPECT_TRUE(chain.reset());
}

TEST_F(EnableLine, EnableBeatsAtTwentyFiveHertzWhileTheServosDo) {
  ASSERT_TRUE(start());
  EXPECT_EQ(beats_within(milliseconds(1000)), 50U);
  EXPECT_TRUE(chain.status().is_enable_beating);
}

// The relay may have fallen, and what it gave power to is driven on: to beat again would give the
// force back in one step.
TEST_F(EnableLine, ServosThatPauseForTwoBeatsStopAndTheirReturnDoesNotResume) {
  ASSERT_TRUE(start());
  run(milliseconds(100));
  is_servo_beating = false;
  run(kEnableGap + kEnableHalfPeriod);
  expect_stopped(ChainTrouble::EnablePaused);
  is_servo_beating = true;
  EXPECT_LE(beats_within(milliseconds(1000)), 1U) << "low, and no more";
  expect_stopped(ChainTrouble::EnablePaused);
  EXPECT_EQ(chain.status().trouble, ChainTrouble::None) << "a person is awaited";
  EXPECT_TRUE(chain.reset());
  EXPECT_EQ(beats_within(milliseconds(1000)), 50U);
  EXPECT_EQ(chain.status().stops, 1U);
}

TEST_F(EnableLine, ABeatThatIsMissedNowAndThenIsNoStop) {
  ASSERT_TRUE(start());
  for (int i = 0; i < 200; ++i) {
    is_servo_beating = i % 4 != 0;
    run(kEnableHalfPeriod);
    ASSERT_FALSE(chain.status().is_stopped) << i;
  }
}

// Each rise is 80 ms after the last then, though there is a beat every 40.
TEST_F(EnableLine, EverySecondBeatMissedIsAPauseOfTheCharges) {
  ASSERT_TRUE(start());
  run(milliseconds(100));
  for (int i = 0; i < 8; ++i) {
    is_servo_beating = i % 2 != 0;
    run(kEnableHalfPeriod);
  }
  expect_stopped(ChainTrouble::EnablePaused);
}

TEST_F(EnableLine, AStepThatComesAfterThePauseStopsBeforeItBeats) {
  ASSERT_TRUE(start());
  run(milliseconds(100));
  const std::uint64_t before = chip.changes(3);
  clock.run_for(2 * kEnableGap);
  EXPECT_TRUE(step().is_stopped);
  expect_stopped(ChainTrouble::EnablePaused);
  EXPECT_LE(chip.changes(3), before + 1);
  EXPECT_FALSE(chip.level(3)) << "at rest, at once";
}

// Of one that answers nothing either only the silence of its inputs is heard.
TEST_F(EnableLine, WhereThereIsNoEnableAChipMayBeSilentForLonger) {
  SafetyChain sut({.estop_channels = 1});
  const auto own = chip.open({"bench", {"5"}, {}}, nullptr).value();
  const auto step_for = [&](Duration duration) {
    for (Duration run{}; run < duration; run += kStep) {
      clock.run_for(kStep);
      sut.step(own.get(), clock.now(), [] { return true; });
    }
  };
  step_for(milliseconds(100));
  ASSERT_TRUE(sut.reset());
  chip.hang(true);
  step_for(kSilence);
  EXPECT_FALSE(sut.status().is_stopped);
  step_for(milliseconds(10));
  EXPECT_EQ(sut.status().cause, ChainTrouble::Silent);
}

TEST_F(EnableLine, WhereThereIsNoEnableNothingWaitsForTheServosBeats) {
  SafetyChain sut({.estop_channels = 1});
  const auto own = chip.open({"bench", {"5"}, {}}, nullptr).value();
  const auto never = [] { return false; };
  for (int i = 0; i < 100; ++i) {
    clock.run_for(kStep);
    sut.step(own.get(), clock.now(), never);
    if (i == 10) {
      EXPECT_TRUE(sut.reset());
    }
  }
  EXPECT_FALSE(sut.status().is_stopped);
}

TEST_F(EnableLine, EnableStopsWithTheStop) {
  ASSERT_TRUE(start());
  run(milliseconds(500));
  press(true);
  step();
  EXPECT_LE(beats_within(milliseconds(1000)), 1U) << "to low, where it was high";
  EXPECT_FALSE(chip.level(3));
  press(false);
  EXPECT_EQ(beats_within(milliseconds(1000)), 0U);
}

TEST_F(EnableLine, EnableIsLowWhenTheLinesAreClosed) {
  ASSERT_TRUE(start());
  while (!chip.level(3)) step();
  lines.reset();
  EXPECT_FALSE(chip.level(3));
}

TEST_F(EnableLine, TheServosAreAskedOncePerBeat) {
  ASSERT_TRUE(start());
  asked = 0;
  run(milliseconds(1000));
  EXPECT_EQ(asked, 50);
}

}  // namespace
}  // namespace thimble::safety
