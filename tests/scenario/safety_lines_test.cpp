// Buttons and wires in front of a whole session: the chip is simulated, everything behind it is
// real.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <thread>
#include <utility>

#include "daemon/app/arm_commands.hpp"
#include "daemon/session/safety_session.hpp"
#include "sim/bus/sim_gpio.hpp"
#include "sim/model/falcon/falcon_arm_model.hpp"
#include "tests/scenario/at_each_rate.hpp"
#include "tests/support/arm_watch.hpp"
#include "tests/support/closed_loop.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

const std::vector<std::string> kLeaning{"arm.hand.motion=poke", "arm.hand.reach_m=0.03"};
constexpr api::ClientId kHer{7};

config::SafetyConfig lines() {
  config::SafetyConfig out;
  out.chip = "bench";
  out.estop = {"0", "1"};
  out.deadman = "2";
  out.enable = "3";
  out.lamp = "4";
  return out;
}

// A session with its safety lines and a person at the command line.
struct Lab {
  explicit Lab(const std::vector<std::string>& overrides, const test::ClosedLoop::Setup& setup = {})
      : loop(overrides, setup) {}

  void tick() {
    safety.step(loop.now());
    loop.tick();
    commands.poll();
  }
  void run(
      double s, const std::function<void()>& each = [] {}) {
    for (const MonotonicTime end = loop.now() + from_seconds(s); loop.now() < end;) {
      tick();
      each();
    }
  }
  bool run_until(double s, const std::function<bool()>& condition) {
    for (const MonotonicTime end = loop.now() + from_seconds(s); loop.now() < end; tick()) {
      if (condition()) return true;
    }
    return condition();
  }
  Result<api::Done> clear() {
    std::optional<Result<api::Done>> told;
    commands.clear_fault("right", {}, kHer, [&](const Result<api::Done>& done) { told = done; });
    run_until(3, [&] { return told.has_value(); });
    return told.value_or(fail(Errc::System, "no answer at all"));
  }
  // Cleared, driven, and a wall that pushes.
  void start() {
    run(0.01);
    ASSERT_TRUE(clear());
    ASSERT_TRUE(run_until(8, [&] { return is_pushed(); }));
  }
  bool is_pushed() { return loop.frame().is_in_contact && norm(loop.frame().force) > 0.2; }
  bool is_active() { return loop.frame().state == OperatingState::Active; }
  void press(bool is_pressed) {
    chip.set_level(0, is_pressed);
    chip.set_level(1, is_pressed);
  }

  test::ClosedLoop loop;
  sim::SimGpioChip chip{loop.arm().clock(), "bench", 8};
  sim::SimGpioChips chips{{&chip}};
  session::SafetySession safety{lines(), loop.runtime(), chips, nullptr};
  app::Leases leases{{{"right", true}}};
  app::ArmCommands commands{loop.runtime(), leases, loop.arm().clock(), &safety};
};

class SafetyLines : public test::AtEachRate {};
THIMBLE_AT_EACH_RATE(SafetyLines);

TEST_P(SafetyLines, NothingIsDrivenFromTheStartUntilAPersonClears) {
  Lab sut(with(kLeaning));
  sut.run(2, [&] { ASSERT_EQ(norm(sut.loop.frame().force), 0); });
  EXPECT_EQ(sut.loop.snapshot().fault.code, FaultCode::Estop);
  EXPECT_EQ(sut.chip.changes(3), 0U);
  EXPECT_THAT(sut.safety.explanation(), HasSubstr("not yet cleared since the start"));
  ASSERT_TRUE(sut.clear());
  EXPECT_TRUE(sut.run_until(8, [&] { return sut.is_pushed(); }));
}

TEST_P(SafetyLines, AnEstopWhilePushingIsZeroWithinTwoMillisecondsAndNeedsAPersonToGoOn) {
  Lab sut(with(kLeaning));
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
  ASSERT_TRUE(sut.clear());
  EXPECT_TRUE(sut.run_until(8, [&] { return sut.is_pushed(); }));
  EXPECT_EQ(watch.breach(), "");
}

TEST_P(SafetyLines, AReleasedDeadmanRampsToZeroWithinTwentyMillisecondsAndIsNoFault) {
  Lab sut(with(kLeaning));
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

struct SafetyLinesTest : testing::Test, Lab {
  SafetyLinesTest() : Lab(kLeaning) {}
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
  EXPECT_TRUE(clear());
  EXPECT_TRUE(run_until(8, [&] { return is_pushed(); }));
}

TEST_F(SafetyLinesTest, AChipThatComesLaterThanTheDaemonIsFound) {
  chip.lose();
  run(2);
  EXPECT_FALSE(clear());
  chip.restore();
  run(1);
  EXPECT_TRUE(clear());
}

TEST_F(SafetyLinesTest, EnableStopsWhenTheServoStalls) {
  start();
  const std::uint64_t before = chip.changes(3);
  run(0.5);
  EXPECT_NEAR(static_cast<double>(chip.changes(3) - before), 25, 1);
  const std::uint64_t stalled = chip.changes(3);
  for (int i = 0; i < 500; ++i) {  // time goes on, and nobody ticks
    (void)loop.arm().clock().sleep_until(loop.now() + milliseconds(1));
    safety.step(loop.now());
  }
  EXPECT_LE(chip.changes(3) - stalled, 1U) << "the tick before the stall";
  EXPECT_FALSE(safety.status().is_enable_beating);
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

// The relay of docs/safety-wiring.md, and a Falcon's supply behind it.
class Relay {
 public:
  explicit Relay(Lab& lab) : lab_(lab) {}
  void see() {
    const std::uint64_t changes = lab_.chip.changes(3);
    if (changes != seen_) beaten_at_ = lab_.loop.now();
    seen_ = changes;
    const bool is_closed = lab_.loop.now() - beaten_at_ <= milliseconds(100);
    if (!is_closed && was_closed_) falcon().power_cycle();
    was_closed_ = is_closed;
  }
  [[nodiscard]] bool is_closed() const { return was_closed_; }

 private:
  sim::FalconArmModel& falcon() {
    return dynamic_cast<sim::FalconArmModel&>(lab_.loop.sim_arm().backend());
  }

  Lab& lab_;
  std::uint64_t seen_{0};
  MonotonicTime beaten_at_{};
  bool was_closed_{false};
};

std::vector<std::string> with_falcon(std::vector<std::string> overrides) {
  overrides.emplace_back("arm.0.device=sim:falcon-loaded");
  return overrides;
}

// No watchdog of its own, nothing that could reach it: the hardware ends its force.
TEST_P(SafetyLines, AFalconWhoseCableIsPulledWhileItPushesLosesItsPower) {
  Lab sut(with(with_falcon(kLeaning)));
  Relay relay(sut);
  sut.start();
  sut.run(0.2, [&] { relay.see(); });
  ASSERT_TRUE(sut.run_until(8, [&] {
    relay.see();
    return sut.is_pushed() && norm(sut.loop.truth().motor_force) > 0.05;
  }));
  sut.loop.unplug(sim::Supply::Stays);
  sut.run(0.05, [&] { relay.see(); });
  EXPECT_GT(norm(sut.loop.truth().motor_force), 0.05) << "the last one";
  EXPECT_EQ(sut.safety.status().cause, safety::ChainTrouble::ArmOutOfReach);
  EXPECT_THAT(sut.safety.explanation(), HasSubstr("look at that arm"));
  EXPECT_TRUE(sut.run_until(0.15, [&] {
    relay.see();
    return norm(sut.loop.truth().motor_force) == 0;
  }));
  EXPECT_FALSE(relay.is_closed());
  ASSERT_FALSE(sut.clear());
  sut.run(0.5, [&] { relay.see(); });
  EXPECT_FALSE(relay.is_closed()) << "too soon";

  // It may need its power to be seen again.
  sut.run(0.5, [&] { relay.see(); });
  const Result<api::Done> refused = sut.clear();
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("when it is back"));
  EXPECT_TRUE(sut.run_until(0.1, [&] {
    relay.see();
    return relay.is_closed();
  }));
  EXPECT_EQ(sut.safety.status().stops, 1U) << "once for one loss";
  EXPECT_EQ(norm(sut.loop.truth().motor_force), 0);
}

TEST_P(SafetyLines, SoDoesOneWhoseBusHangs) {
  test::ClosedLoop::Setup setup;
  sim::ScriptedFault hang;
  hang.kind = sim::FaultKind::Stall;
  hang.from = MonotonicTime{std::chrono::seconds(20)};
  setup.cables.script.push_back(hang);
  Lab sut(with(with_falcon({"arm.hand.motion=still"})), setup);
  Relay relay(sut);
  sut.run(0.01);
  ASSERT_TRUE(sut.clear());
  ASSERT_TRUE(sut.run_until(8, [&] { return sut.loop.frame().gain == 1; }));
  sut.loop.sim_arm().backend().push_tip({4.5, 0, 0});
  const auto see = [&] { relay.see(); };
  while (sut.loop.now() < hang.from) {
    sut.tick();
    see();
  }
  ASSERT_GT(norm(sut.loop.truth().motor_force), 0.05);
  sut.run(0.1, see);
  EXPECT_GT(norm(sut.loop.truth().motor_force), 0.05) << "zero does not come through";
  EXPECT_TRUE(sut.run_until(0.3, [&] {
    see();
    return norm(sut.loop.truth().motor_force) == 0;
  }));
  EXPECT_EQ(sut.safety.status().cause, safety::ChainTrouble::ArmOutOfReach);
}

// Silence that ends is the servo's own affair, and one lost answer is none.
TEST_P(SafetyLines, AFalconThatAnswersAgainAfterAFaultKeepsItsPower) {
  test::ClosedLoop::Setup setup;
  sim::ScriptedFault silence;
  silence.kind = sim::FaultKind::Stall;
  silence.from = MonotonicTime{std::chrono::seconds(20)};
  silence.lasts = milliseconds(90);
  setup.cables.script.push_back(silence);
  Lab sut(with(with_falcon({"arm.hand.motion=still"})), setup);
  sut.run(0.01);
  ASSERT_TRUE(sut.clear());
  ASSERT_TRUE(sut.run_until(8, [&] { return sut.loop.frame().gain == 1; }));
  ASSERT_TRUE(sut.run_until(20, [&] { return sut.loop.frame().state == OperatingState::Fault; }));
  sut.run(1);
  EXPECT_EQ(sut.safety.status().stops, 0U);
  EXPECT_TRUE(sut.safety.status().is_enable_beating);
  EXPECT_EQ(norm(sut.loop.truth().motor_force), 0);
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
  session::SafetySession sut(lines(), loop.runtime(), slow, nullptr);
  int exchanged = 0;
  slow.wait = [&] {
    std::thread([&] { sut.exchange_arms([&] { ++exchanged; }); }).join();
    EXPECT_FALSE(loop.controls().is_estop_healthy);
  };
  sut.step(loop.now());
  EXPECT_EQ(exchanged, 1) << "opened";
  for (int i = 0; i < 10; ++i) {
    loop.tick();
    sut.step(loop.now());
  }
  sut.ask_reset();
  sut.step(loop.now());
  ASSERT_TRUE(loop.controls().is_estop_healthy);
  chip.lose();
  sut.step(loop.now());
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

TEST_F(SafetyLinesTest, AFaultOfAnotherKindIsClearedThroughTheChain) {
  start();
  loop.tick(milliseconds(30));
  ASSERT_EQ(loop.snapshot().fault.code, FaultCode::ServoLate);
  press(true);
  run(0.05);
  press(false);
  run(0.05);
  ASSERT_TRUE(safety.status().is_stopped);
  EXPECT_TRUE(clear());
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
      } else if (clear()) {
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
