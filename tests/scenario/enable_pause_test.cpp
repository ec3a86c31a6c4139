// ENABLE that pauses for so long that its relay may have fallen: the arm behind it has lost its
// power for a while, is none the wiser, and must not get it back while it is driven.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/scenario/safety_lab.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

struct EnablePause : testing::Test, test::SafetyLab {
  EnablePause() : SafetyLab(test::kPoking) {}

  std::uint64_t beats_within(double s) {
    const std::uint64_t before = chip.changes(3);
    run(s);
    return chip.changes(3) - before;
  }
  // Of whatever made it: nothing is driven and nothing beats until a person clears.
  void expect_stopped_until_cleared() {
    EXPECT_LE(beats_within(0.1), 1U) << "low, and no more";
    EXPECT_TRUE(safety.status().is_stopped);
    EXPECT_FALSE(safety.status().is_enable_beating);
    EXPECT_EQ(safety.status().stops, 1U);
    run(0.5, [&] { ASSERT_EQ(norm(loop.frame().force), 0); });
    EXPECT_EQ(loop.frame().state, OperatingState::Fault);
    ASSERT_TRUE(clear_and_hold());
    EXPECT_GE(beats_within(0.5), 24U);
    EXPECT_TRUE(run_until(8, [&] { return is_pushed(); }));
  }
};

TEST_F(EnablePause, OfAServoThatStallsStopsAllArms) {
  start();
  EXPECT_NEAR(static_cast<double>(beats_within(0.5)), 25, 1);
  const std::uint64_t stalled = chip.changes(3);
  for (int i = 0; i < 150; ++i) {  // time goes on, and nobody ticks
    (void)loop.arm().clock().sleep_until(loop.now() + milliseconds(1));
    safety.step(loop.arm().clock());
  }
  EXPECT_LE(chip.changes(3) - stalled, 2U) << "the tick before the stall, and low";
  EXPECT_EQ(safety.status().cause, safety::ChainTrouble::EnablePaused);
  EXPECT_THAT(safety.explanation(), HasSubstr("the motors' power may have been cut"));
  EXPECT_FALSE(loop.controls().is_estop_healthy);
  expect_stopped_until_cleared();
}

TEST_F(EnablePause, OfTheThreadOfTheLinesStopsAsSoonAsItLooks) {
  start();
  ASSERT_TRUE(run_until(8, [&] { return is_pushed(); }));
  for (int i = 0; i < 150; ++i) loop.tick();  // and nobody looks after the lines
  EXPECT_TRUE(is_active());
  const std::uint64_t before = chip.changes(3);
  safety.step(loop.arm().clock());
  EXPECT_EQ(safety.status().cause, safety::ChainTrouble::EnablePaused);
  EXPECT_LE(chip.changes(3) - before, 1U);
  EXPECT_FALSE(chip.level(3));
  expect_stopped_until_cleared();
  EXPECT_EQ(loop.snapshot().fault.code, FaultCode::None);
}

TEST_F(EnablePause, OfAChipThatTakesNoOutputStopsBeforeItsInputsAreMissed) {
  start();
  run(0.1);
  chip.hang(true);
  run(0.1);
  EXPECT_EQ(loop.snapshot().fault.code, FaultCode::Estop);
  EXPECT_EQ(safety.status().cause, safety::ChainTrouble::OutputStuck);
  chip.hang(false);
  expect_stopped_until_cleared();
}

// It holds no force, and nobody else's is to be taken away for it.
TEST_F(EnablePause, OfAServoThatEndsToBeExchangedStopsNobody) {
  start();
  const auto wait = [&] {
    for (int i = 0; i < 150; ++i) {  // time goes on, and that one does not tick
      (void)loop.arm().clock().sleep_until(loop.now() + milliseconds(1));
      safety.step(loop.arm().clock());
    }
  };
  safety.leave_out(0);
  const std::uint64_t before = chip.changes(3);
  wait();
  EXPECT_FALSE(safety.status().is_stopped);
  EXPECT_GE(chip.changes(3) - before, 7U);
  safety.exchange_arms([] {});
  EXPECT_FALSE(safety.status().is_stopped);
  wait();
  EXPECT_EQ(safety.status().cause, safety::ChainTrouble::EnablePaused) << "of whoever is there now";
}

TEST_F(EnablePause, OfOneBeatIsNone) {
  start();
  ASSERT_TRUE(run_until(8, [&] { return is_pushed(); }));
  for (int turn = 0; turn < 20; ++turn) {
    for (int i = 0; i < 25; ++i) loop.tick();
    run(0.1);
    ASSERT_FALSE(safety.status().is_stopped);
    ASSERT_TRUE(is_active());
  }
}

}  // namespace
}  // namespace thimble
