// What a closed deadman counts for: decision 0520.
#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "tests/unit/safety/safety_bench.hpp"

namespace thimble::safety {
namespace {

using std::chrono::milliseconds;

struct DeadmanTest : testing::Test, SafetyBench {};

TEST_F(DeadmanTest, TheDeadmanIsHeldWhileItsContactIsClosedAndItsReleaseIsNoStop) {
  ASSERT_TRUE(start());
  EXPECT_TRUE(step().is_deadman_held);
  chip.set_level(2, true);
  EXPECT_FALSE(step().is_deadman_held);
  EXPECT_FALSE(chain.status().is_stopped);
  chip.set_level(2, false);
  step();
  EXPECT_TRUE(step().is_deadman_held);
  chip.lose();
  EXPECT_FALSE(step().is_deadman_held);
}

TEST_F(DeadmanTest, ADeadmanThatIsClosedFromTheStartCountsOnceItWasLetGoOf) {
  run(milliseconds(500));
  ASSERT_TRUE(chain.reset());
  run(milliseconds(500));
  EXPECT_FALSE(chain.status().is_stopped);
  EXPECT_FALSE(chain.status().is_deadman_held);
  EXPECT_TRUE(chain.status().must_release_deadman);
  let_go(true);
  run(kStep * 2);
  EXPECT_FALSE(chain.status().must_release_deadman);
  EXPECT_FALSE(chain.status().is_deadman_held) << "it is open";
  let_go(false);
  run(kStep * 2);
  EXPECT_TRUE(chain.status().is_deadman_held);
}

TEST_F(DeadmanTest, EveryStopAsksForTheDeadmanToBeLetGoOfAnew) {
  const auto stop = {
      +[](DeadmanTest& sut) {
        sut.press(true);
        sut.run(kStep * 4);
        sut.press(false);
      },
      +[](DeadmanTest& sut) { sut.replug(); },
      +[](DeadmanTest& sut) { sut.chain.stop(ChainTrouble::Unwatched); },
      +[](DeadmanTest& sut) {
        sut.chain.hold(ChainTrouble::ArmOutOfReach, sut.clock.now() + milliseconds(50));
      },
  };
  for (const auto& each : stop) {
    ASSERT_TRUE(start());
    ASSERT_TRUE(step().is_deadman_held);
    each(*this);
    run(milliseconds(500));
    ASSERT_TRUE(chain.reset());
    EXPECT_FALSE(step().is_deadman_held) << "as it was held before, so it may be stuck";
    EXPECT_TRUE(chain.status().must_release_deadman);
    take_hold_anew();
    EXPECT_TRUE(chain.status().is_deadman_held);
  }
}

TEST_F(DeadmanTest, WhatTheDeadmanDidBeforeTheStopOrWhileNobodyCouldReadItDoesNotCount) {
  ASSERT_TRUE(start());
  take_hold_anew();
  chip.lose();
  run(kStep);
  let_go(true);
  run(kStep);
  let_go(false);
  chip.restore();
  lines = open();
  chain.restart_lines();
  run(milliseconds(100));
  EXPECT_TRUE(chain.status().must_release_deadman);
  EXPECT_FALSE(chain.status().is_deadman_held);
}

TEST_F(DeadmanTest, WhatItDidBeforeItsLinesWentOrFellSilentDoesNotCountThoughAllWasStoppedAlready) {
  const auto lose = {
      +[](DeadmanTest& sut) { sut.replug(); },
      +[](DeadmanTest& sut) {
        sut.chip.hang(true);
        sut.run(milliseconds(300));
        sut.chip.hang(false);
      },
      +[](DeadmanTest& sut) {  // between two steps
        sut.lines = nullptr;
        sut.lines = sut.open();
        sut.chain.restart_lines();
      },
  };
  for (const auto& each : lose) {
    press(true);
    let_go(true);
    run(kStep * 4);
    each(*this);
    let_go(false);  // by whoever works at its wires
    press(false);
    run(milliseconds(100));
    ASSERT_TRUE(chain.reset());
    EXPECT_FALSE(step().is_deadman_held);
    EXPECT_TRUE(chain.status().must_release_deadman);
  }
}

// As a CP2112, which is read every 20 ms.
class SeldomRead final : public bus::GpioLines {
 public:
  SeldomRead(std::unique_ptr<bus::GpioLines> lines, const Clock& clock)
      : lines_(std::move(lines)), clock_(clock) {}
  IoStatus next_edge(bus::GpioEdge& out) noexcept override { return lines_->next_edge(out); }
  IoStatus levels(bus::GpioLevels& out) noexcept override {
    if (clock_.now() - newest_.read_at >= bus::kGpioReadPeriod) {
      if (const IoStatus status = lines_->levels(newest_); status != IoStatus::Ok) return status;
    }
    out = newest_;
    return IoStatus::Ok;
  }
  IoStatus set(std::size_t output, bool is_high) noexcept override {
    return lines_->set(output, is_high);
  }

 private:
  std::unique_ptr<bus::GpioLines> lines_;
  const Clock& clock_;
  bus::GpioLevels newest_{};
};

TEST_F(DeadmanTest, AReadingOfBeforeTheStopSaysNothingOfWhatFollowsIt) {
  lines = std::make_unique<SeldomRead>(std::move(lines), clock);
  ASSERT_TRUE(start());
  for (int steps_after_reading = 0; steps_after_reading < 4; ++steps_after_reading) {
    let_go(true);
    run(bus::kGpioReadPeriod * 3);
    run(kStep * steps_after_reading);
    let_go(false);  // taken, and welded
    chain.stop(ChainTrouble::Unwatched);
    run(milliseconds(200));
    ASSERT_TRUE(chain.reset());
    EXPECT_TRUE(step().must_release_deadman) << steps_after_reading;
    take_hold_anew();
  }
}

TEST_F(DeadmanTest, ABounceThatOneReadingMeetsIsNotALettingGo) {
  run(kStep * 4);
  for (int i = 0; i < 20; ++i) {
    let_go(true);
    step();
    let_go(false);
    run(kStep * 2);
    EXPECT_TRUE(chain.status().must_release_deadman);
  }
}

TEST_F(DeadmanTest, LetGoOfWhileStoppedItCountsAndAnOpenOneAsksForNothing) {
  ASSERT_TRUE(start());
  press(true);
  run(kStep * 4);
  take_hold_anew();
  press(false);
  run(milliseconds(100));
  ASSERT_TRUE(chain.reset());
  EXPECT_TRUE(step().is_deadman_held);
  let_go(true);
  press(true);
  run(kStep * 4);
  EXPECT_FALSE(chain.status().must_release_deadman);
  press(false);
  run(milliseconds(100));
  let_go(false);
  run(kStep * 2);
  EXPECT_TRUE(chain.status().is_deadman_held) << "it was open after the stop";
}

// A bounce shorter than any reading is no hand.
TEST_F(DeadmanTest, APulseOfTheDeadmanIsNotALettingGo) {
  run(kStep * 4);
  for (int i = 0; i < 20; ++i) {
    let_go(true);
    let_go(false);
    step();
    EXPECT_FALSE(chain.status().is_deadman_held);
  }
  run(kStep);
  EXPECT_TRUE(chain.status().must_release_deadman);
}

TEST_F(DeadmanTest, WithoutADeadmanItCountsAsHeldWhileThereAreLines) {
  SafetyChain sut({.estop_channels = 1});
  const auto own = chip.open({"bench", {"5"}, {}}, nullptr).value();
  sut.step(own.get(), clock.now(), [] { return true; });
  EXPECT_TRUE(sut.status().is_deadman_held);
  EXPECT_TRUE(sut.reset());
  sut.step(nullptr, clock.now(), [] { return true; });
  EXPECT_FALSE(sut.status().is_deadman_held);
  EXPECT_TRUE(sut.status().is_stopped);
}

}  // namespace
}  // namespace thimble::safety
