// Buttons and wires in front of a whole session: the chip is simulated, everything behind it is
// real.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <random>
#include <thread>
#include <utility>

#include "tests/scenario/at_each_rate.hpp"
#include "tests/scenario/safety_lab.hpp"
#include "tests/support/arm_watch.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using test::SafetyLab;
using testing::HasSubstr;

class SafetyLines : public test::AtEachRate {};
THIMBLE_AT_EACH_RATE(SafetyLines);

TEST_P(SafetyLines, NothingIsDrivenFromTheStartUntilAPersonClears) {
  SafetyLab sut(with(test::kPoking));
  sut.run(2, [&] { ASSERT_EQ(norm(sut.loop.frame().force), 0); });
  EXPECT_EQ(sut.loop.snapshot().fault.code, FaultCode::Estop);
  EXPECT_EQ(sut.chip.changes(3), 0U);
  EXPECT_THAT(sut.safety.explanation(), HasSubstr("not yet cleared since the start"));
  ASSERT_TRUE(sut.clear_and_hold());
  EXPECT_TRUE(sut.run_until(8, [&] { return sut.is_pushed(); }));
}

TEST_P(SafetyLines, AnEstopWhilePushingIsZeroWithinTwoMillisecondsAndNeedsAPersonToGoOn) {
  SafetyLab sut(with(test::kPoking));
  sut.start();
  test::ArmWatch watch(sut.loop);
  const MonotonicTime pressed = sut.loop.now();
  sut.press(true);
  sut.tick();
  EXPECT_EQ(norm(sut.loop.frame().force), 0);
  EXPECT_LE(sut.loop.now() - pressed, milliseconds(2));
  EXPECT_EQ(sut.loop.snapshot().fault.code, FaultCode::Estop);
  const Result<api::Done> refused = sut.clear();
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("emergency stop is pressed"));
  sut.press(false);
  sut.run(1, [&] {
    watch.see();
    ASSERT_EQ(norm(sut.loop.frame().force), 0) << "released is not cleared";
  });
  ASSERT_TRUE(sut.clear_and_hold());
  EXPECT_TRUE(sut.run_until(8, [&] { return sut.is_pushed(); }));
  EXPECT_EQ(watch.breach(), "");
}

TEST_P(SafetyLines, AReleasedDeadmanRampsToZeroWithinTwentyMillisecondsAndIsNoFault) {
  SafetyLab sut(with(test::kPoking));
  sut.start();
  test::ArmWatch watch(sut.loop);
  sut.chip.set_level(2, true);
  sut.run(0.020, [&] { watch.see(); });
  EXPECT_NEAR(norm(sut.loop.frame().force), 0, 1e-9);
  EXPECT_EQ(sut.loop.snapshot().faults, 1U) << "that of the start";
  EXPECT_TRUE(sut.is_active());
  sut.chip.set_level(2, false);
  EXPECT_TRUE(sut.run_until(8, [&] { return sut.is_pushed(); }));
  EXPECT_EQ(watch.breach(), "");
}

TEST_P(SafetyLines, ADeadmanThatWasHeldAllAlongGivesNoForceUntilItIsLetGoOf) {
  SafetyLab sut(with(test::kPoking));
  const auto feels_nothing = [&] { ASSERT_EQ(norm(sut.loop.frame().force), 0); };
  sut.run(0.01);
  ASSERT_TRUE(sut.clear());
  sut.run(4, feels_nothing);
  EXPECT_TRUE(sut.is_active());
  EXPECT_EQ(sut.safety.explanation(), session::kReleaseDeadman);
  sut.take_hold_anew();
  EXPECT_EQ(sut.safety.explanation(), "");
  ASSERT_TRUE(sut.run_until(8, [&] { return sut.is_pushed(); }));
  sut.press(true);
  sut.run(0.1);
  sut.press(false);
  sut.run(0.1);
  EXPECT_THAT(sut.safety.explanation(), HasSubstr("; the deadman was not let go of"));
  ASSERT_TRUE(sut.clear());
  sut.run(4, feels_nothing);
  sut.take_hold_anew();
  EXPECT_TRUE(sut.run_until(8, [&] { return sut.is_pushed(); }));
}

struct SafetyLinesTest : testing::Test, SafetyLab {
  SafetyLinesTest() : SafetyLab(test::kPoking) {}
};

TEST_F(SafetyLinesTest, ChannelsThatDisagreeStayAStopUntilBothWereOpen) {
  start();
  chip.set_level(0, true);  // one contact; the other is welded
  run(0.1);
  EXPECT_EQ(loop.snapshot().fault.code, FaultCode::Estop);
  chip.set_level(0, false);
  run(0.1);
  const Result<api::Done> refused = clear();
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("disagree"));
  press(true);
  run(0.1);
  press(false);
  run(0.1);
  EXPECT_TRUE(clear());
}

TEST_F(SafetyLinesTest, ALostChipStopsTheArmAndItsReturnDoesNotResume) {
  start();
  chip.lose();
  tick();
  EXPECT_EQ(norm(loop.frame().force), 0);
  EXPECT_EQ(loop.snapshot().fault.code, FaultCode::Estop);
  run(1);
  const Result<api::Done> refused = clear();
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("no GPIO chip"));
  chip.restore();
  run(1, [&] { ASSERT_EQ(norm(loop.frame().force), 0); });
  EXPECT_TRUE(clear_and_hold());
  EXPECT_TRUE(run_until(8, [&] { return is_pushed(); }));
}

TEST_F(SafetyLinesTest, OnceAllIsHealthyAgainAPersonIsToldWhatTheStopWas) {
  start();
  press(true);
  run(0.1);
  EXPECT_THAT(safety.explanation(), HasSubstr("the emergency stop is pressed"));
  press(false);
  run(0.1);
  EXPECT_THAT(safety.explanation(), HasSubstr("(the newest stop: the emergency stop was pressed"));
  EXPECT_TRUE(clear_and_hold());
  EXPECT_EQ(safety.explanation(), "");
  chip.lose();
  run(0.1);
  chip.restore();
  run(1);
  EXPECT_THAT(safety.explanation(),
              HasSubstr("(the newest stop: the safety lines were not there)"));
  EXPECT_THAT(safety.explanation(), HasSubstr("clear the fault of each arm"));
}

TEST_F(SafetyLinesTest, AChipThatComesLaterThanTheDaemonIsFound) {
  chip.lose();
  run(2);
  EXPECT_FALSE(clear());
  chip.restore();
  run(1);
  EXPECT_TRUE(clear());
}

TEST_F(SafetyLinesTest, EnableBeatsWhileAnArmStandsStillAfterAFaultOfItsOwn) {
  start();
  loop.unplug();
  run(0.1);
  EXPECT_EQ(loop.frame().state, OperatingState::Lost);
  const std::uint64_t before = chip.changes(3);
  run(0.5);
  EXPECT_GT(chip.changes(3) - before, 20U);
}

TEST_F(SafetyLinesTest, OutputsAreLowWhenItEnds) {
  start();
  ASSERT_TRUE(run_until(1, [&] { return chip.level(3); }));
  safety.close();
  EXPECT_FALSE(chip.level(3));
  EXPECT_FALSE(chip.level(4));
}

TEST_F(SafetyLinesTest, ArmsThatAreExchangedHearOfAStopBeforeTheyAreDriven) {
  run(0.1);
  bool has_changed = false;
  safety.exchange_arms([&] {
    loop.controls().is_estop_healthy = true;  // as a new arm comes
    has_changed = true;
  });
  EXPECT_TRUE(has_changed);
  EXPECT_FALSE(loop.controls().is_estop_healthy);
}

// Lines, and the chips they are of, that open and close when `wait` returns.
class SlowLines final : public bus::GpioLines {
 public:
  SlowLines(std::unique_ptr<bus::GpioLines> lines, std::function<void()> wait)
      : lines_(std::move(lines)), wait_(std::move(wait)) {}
  ~SlowLines() override { wait_(); }
  SlowLines(const SlowLines&) = delete;
  SlowLines& operator=(const SlowLines&) = delete;
  IoStatus next_edge(bus::GpioEdge& out) noexcept override { return lines_->next_edge(out); }
  IoStatus levels(bus::GpioLevels& out) noexcept override { return lines_->levels(out); }
  IoStatus set(std::size_t output, bool is_high) noexcept override {
    return lines_->set(output, is_high);
  }

 private:
  std::unique_ptr<bus::GpioLines> lines_;
  std::function<void()> wait_;
};

class SlowChips final : public bus::GpioChips {
 public:
  explicit SlowChips(bus::GpioChips& chips) : chips_(chips) {}
  Result<std::unique_ptr<bus::GpioLines>> open(const bus::GpioClaim& claim,
                                               rt::WakeSignal* wake) override {
    wait();
    auto opened = chips_.open(claim, wake);
    if (!opened) return opened;
    return std::make_unique<SlowLines>(*std::move(opened), [this] { wait(); });
  }
  std::function<void()> wait = [] {};

 private:
  bus::GpioChips& chips_;
};

// An adapter that opens or closes only when the arms were exchanged: whoever exchanges them, and
// computes the worlds, does not wait for it. A deadlock otherwise.
TEST_F(SafetyLinesTest, AChipThatHangsWhileItOpensOrClosesHoldsNobodyUp) {
  safety.close();
  SlowChips slow(chips);
  session::SafetySession sut(test::safety_lines(), loop.runtime(), slow, nullptr);
  int exchanged = 0;
  slow.wait = [&] {
    std::thread([&] { sut.exchange_arms([&] { ++exchanged; }); }).join();
    EXPECT_FALSE(loop.controls().is_estop_healthy);
  };
  sut.step(loop.arm().clock());
  EXPECT_EQ(exchanged, 1) << "opened";
  for (int i = 0; i < 10; ++i) {
    loop.tick();
    sut.step(loop.arm().clock());
  }
  sut.ask_reset();
  sut.step(loop.arm().clock());
  ASSERT_TRUE(loop.controls().is_estop_healthy);
  chip.lose();
  sut.step(loop.arm().clock());
  EXPECT_EQ(exchanged, 2) << "closed, and the arms were stopped before";
  EXPECT_FALSE(loop.controls().is_estop_healthy);
}

TEST_F(SafetyLinesTest, AThreadThatDoesNotLookAfterThemIsAStop) {
  start();
  for (int i = 0; i < 399; ++i) loop.tick();
  safety.supervise(loop.now());
  EXPECT_TRUE(is_active());
  for (int i = 0; i < 3; ++i) loop.tick();
  safety.supervise(loop.now());
  loop.tick();
  EXPECT_EQ(loop.snapshot().fault.code, FaultCode::Estop);
  run(0.1);
  EXPECT_EQ(safety.status().cause, safety::ChainTrouble::Unwatched);
  EXPECT_TRUE(clear());
}

TEST_F(SafetyLinesTest, AClearFromBeforeAStopOfTheThreadItselfLetsNothingGo) {
  start();
  safety.ask_reset();
  safety.supervise(loop.now() + milliseconds(500));
  safety.step(loop.arm().clock());
  EXPECT_TRUE(safety.status().is_stopped);
  EXPECT_FALSE(safety.answer().is_free);
  EXPECT_FALSE(loop.controls().is_estop_healthy);
  run(0.1, [&] { ASSERT_EQ(norm(loop.frame().force), 0); });
  EXPECT_EQ(loop.snapshot().fault.code, FaultCode::Estop);
  EXPECT_TRUE(clear());
}

TEST_F(SafetyLinesTest, ArmsThatComeWhileTheThreadHangsAreStoppedToo) {
  start();
  safety.supervise(loop.now() + milliseconds(500));
  EXPECT_FALSE(loop.controls().is_deadman_held);
  EXPECT_TRUE(safety.status().is_stopped);
  EXPECT_EQ(safety.status().trouble, safety::ChainTrouble::Unwatched);
  safety.exchange_arms([&] {
    loop.controls().is_estop_healthy = true;  // as a new arm comes
    loop.controls().is_deadman_held = true;
  });
  EXPECT_FALSE(loop.controls().is_estop_healthy);
  EXPECT_FALSE(loop.controls().is_deadman_held);
}

// Who was refused, because the adapter hung, finds nothing let go when it comes to itself.
TEST_F(SafetyLinesTest, AClearFromBeforeTheLinesWereOpenedLetsNothingGo) {
  safety.close();
  SlowChips slow(chips);
  session::SafetySession sut(test::safety_lines(), loop.runtime(), slow, nullptr);
  slow.wait = [&] { sut.ask_reset(); };
  sut.step(loop.arm().clock());
  EXPECT_EQ(sut.status().trouble, safety::ChainTrouble::None);
  EXPECT_TRUE(sut.status().is_stopped);
  EXPECT_EQ(sut.answer().id, 1U);
  EXPECT_FALSE(sut.answer().is_free);
  slow.wait = [] {};
  for (int i = 0; i < 20; ++i) {
    loop.tick();
    sut.step(loop.arm().clock());
  }
  EXPECT_TRUE(sut.status().is_stopped);
}

TEST_F(SafetyLinesTest, AClearThatWaitedForTooLongIsSpent) {
  start();
  press(true);
  run(0.1);
  press(false);
  run(0.1);
  safety.ask_reset();
  (void)loop.arm().clock().sleep_until(loop.now() + milliseconds(500));
  safety.step(loop.arm().clock());
  EXPECT_TRUE(safety.status().is_stopped);
  EXPECT_FALSE(safety.answer().is_free);
  run(0.1);
  EXPECT_TRUE(safety.status().is_stopped);
}

TEST_F(SafetyLinesTest, AFaultOfAnotherKindIsClearedThroughTheChain) {
  start();
  loop.tick(milliseconds(30));
  ASSERT_EQ(loop.snapshot().fault.code, FaultCode::ServoLate);
  press(true);
  run(0.05);
  press(false);
  run(0.05);
  ASSERT_TRUE(safety.status().is_stopped);
  EXPECT_TRUE(clear_and_hold());
  EXPECT_FALSE(safety.status().is_stopped);
  EXPECT_TRUE(run_until(8, [&] { return is_pushed(); }));
}

// Whatever people and wires do: no force in a tick that begins with an open channel, nor after one
// before somebody has cleared.
TEST_F(SafetyLinesTest, NoForceFollowsAnOpenChannelBeforeSomebodyClears) {
  start();
  test::ArmWatch watch(loop);
  for (unsigned seed = 1; seed <= 8; ++seed) {
    std::mt19937 dice(seed);
    bool is_stopped = safety.status().is_stopped;
    int driven = 0;
    for (int step = 0; step < 400; ++step) {
      const auto roll = dice() % 10;
      if (roll < 2) {
        press(true);
        is_stopped = true;
      } else if (roll == 2) {
        const std::size_t channel = dice() % 2;
        chip.bounce(channel, !chip.level(channel), static_cast<int>(dice() % 3));
        is_stopped = true;
      } else if (roll < 7) {
        press(false);
      } else if (clear_and_hold()) {
        ASSERT_FALSE(chip.level(0) || chip.level(1));
        is_stopped = false;
      }
      run(0.02, [&] {
        watch.see();
        if (!is_stopped) return;
        ASSERT_EQ(norm(loop.frame().force), 0) << seed << " step " << step;
      });
      driven += is_active() ? 1 : 0;
    }
    EXPECT_GT(driven, 10) << seed;
  }
  EXPECT_EQ(watch.breach(), "");
}

}  // namespace
}  // namespace thimble
