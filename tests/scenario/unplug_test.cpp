#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tests/scenario/at_each_rate.hpp"
#include "tests/scenario/two_explorers.hpp"
#include "tests/support/arm_watch.hpp"

namespace thimble {
namespace {

using test::ArmWatch;
using test::ClosedLoop;

const std::vector<std::string> kStill{"arm.hand.motion=still"};

class Unplug : public test::AtEachRate {
 protected:
  // Its person has calibrated it, and it waits for a clear.
  static void run_until_calibrated(ClosedLoop& loop, ArmWatch& watch) {
    ASSERT_TRUE(loop.run_until(8,
                               [&] {
                                 watch.see();
                                 EXPECT_EQ(norm(loop.frame().force), 0);
                                 return loop.frame().state == OperatingState::Fault;
                               }))
        << "state " << to_string(loop.frame().state) << ": " << loop.instruction();
    EXPECT_EQ(loop.frame().calibration, CalibrationState::Ok);
    EXPECT_EQ(loop.snapshot().fault.code, FaultCode::Disconnected);
  }
  static void clear(ClosedLoop& loop) {
    loop.controls().request_clear(loop.snapshot().fault.number);
  }
  static void run_until_active(ClosedLoop& loop, ArmWatch& watch) {
    ASSERT_TRUE(loop.run_until(4,
                               [&] {
                                 watch.see();
                                 const servo::ServoFrame& frame = loop.frame();
                                 if (frame.calibration != CalibrationState::Ok) {
                                   EXPECT_EQ(norm(frame.force), 0);
                                   EXPECT_NE(frame.state, OperatingState::Active);
                                 }
                                 return frame.state == OperatingState::Active;
                               }))
        << "state " << to_string(loop.frame().state);
  }
};
THIMBLE_AT_EACH_RATE(Unplug);

TEST_P(Unplug, WhileTheWallPressesTheMotorsStopAndTheStopIsRecorded) {
  ClosedLoop sut(with(kStill));
  sut.run_until_leaning();
  ArmWatch watch(sut);
  sut.unplug();
  sut.tick();
  EXPECT_EQ(sut.frame().state, OperatingState::Lost);
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::Disconnected);
  EXPECT_EQ(norm(sut.frame().force), 0);
  sut.run(0.005);
  EXPECT_EQ(norm(sut.truth().motor_force), 0) << "no power";
  EXPECT_FALSE(sut.truth().is_amplifier_on);
  sut.run(1, [&] {
    watch.see();
    EXPECT_EQ(sut.frame().state, OperatingState::Lost);
  });
  EXPECT_EQ(watch.breach(), "");
  const std::optional<session::Recording> recording = sut.arm().session().take_recording();
  ASSERT_TRUE(recording.has_value());
  EXPECT_EQ(recording->header.fault.code, FaultCode::Disconnected);
  EXPECT_EQ(recording->header.fault.number, sut.snapshot().fault.number);
  EXPECT_EQ(recording->frames.back().fault, FaultCode::Disconnected);
}

TEST_P(Unplug, AReturnedArmIsCalibratedThenClearedAndDrivenFromZeroWithoutAJump) {
  ClosedLoop sut(with(kStill));
  sut.run_until_leaning();
  ArmWatch watch(sut);
  sut.unplug();
  sut.run(0.3, [&] { watch.see(); });
  sut.sim_arm().backend().push_tip({});
  sut.replug();
  sut.run(0.5, [&] {
    watch.see();
    EXPECT_NE(sut.frame().state, OperatingState::Active);
    EXPECT_NE(sut.instruction(), "");
  });
  run_until_calibrated(sut, watch);
  clear(sut);
  run_until_active(sut, watch);
  EXPECT_EQ(sut.instruction(), "");
  EXPECT_LT(sut.frame().gain, 0.01);
  EXPECT_EQ(norm(sut.frame().offset), 0);
  EXPECT_LT(norm(sut.frame().tip - sut.truth().tip), 0.5e-3) << "the new reference is right";
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::None);

  sut.run(1, [&] { watch.see(); });
  sut.sim_arm().backend().push_tip({4.5, 0, 0});
  sut.run(0.6, [&] { watch.see(); });
  EXPECT_TRUE(sut.frame().is_in_contact);
  EXPECT_GT(norm(sut.truth().motor_force), 1) << "and the wall is where it was";
  EXPECT_EQ(watch.breach(), "");
}

TEST_P(Unplug, ACableThatIsBackBeforeTheNextTickLosesTheArmAllTheSame) {
  ClosedLoop sut(with(kStill));
  sut.run_until_leaning();
  ArmWatch watch(sut);
  sut.unplug();
  sut.replug();
  sut.sim_arm().backend().push_tip({});
  sut.tick();
  watch.see();
  EXPECT_NE(sut.frame().state, OperatingState::Active);
  EXPECT_EQ(norm(sut.frame().force), 0);
  run_until_calibrated(sut, watch);
  clear(sut);
  run_until_active(sut, watch);
  sut.run(0.6, [&] { watch.see(); });
  EXPECT_LT(norm(sut.frame().tip - sut.truth().tip), 0.5e-3);
  EXPECT_EQ(watch.breach(), "");
}

TEST_P(Unplug, AtAnyMomentOfTheCalibrationNothingMovesBeforeItIsDone) {
  ClosedLoop sut(with({"arm.hand.motion=explore"}));
  ArmWatch watch(sut);
  for (const double s : {0.1, 0.57, 0.62, 1.3}) {
    sut.run(s, [&] { watch.see(); });
    sut.unplug();
    sut.run(0.05, [&] { watch.see(); });
    sut.replug();
  }
  run_until_active(sut, watch);
  sut.run(2, [&] { watch.see(); });
  EXPECT_LT(norm(sut.frame().tip - sut.truth().tip), 1e-3);
  EXPECT_EQ(watch.breach(), "");
}

// A person takes as long as it takes to come back from the arm: nothing moves, and what was
// calibrated stays so. An arm of this family forgets where it is when it hears nothing.
TEST_P(Unplug, ACalibratedArmWaitsForItsClearAndForgetsNothing) {
  for (const char* device : {"sim:phantom-vintage", "sim:phantom-vintage-serial"}) {
    SCOPED_TRACE(device);
    ClosedLoop sut(with({std::string("arm.0.device=") + device, "arm.hand.motion=still"}));
    sut.run_until_driven();
    ArmWatch watch(sut);
    sut.unplug();
    sut.run(0.1, [&] { watch.see(); });
    sut.replug();
    run_until_calibrated(sut, watch);
    EXPECT_FALSE(sut.run_until(5, [&] {
      watch.see();
      return sut.frame().state != OperatingState::Fault ||
             sut.frame().calibration != CalibrationState::Ok;
    }));
    clear(sut);
    EXPECT_TRUE(sut.run_until(0.05, [&] {
      watch.see();
      return sut.frame().state == OperatingState::Active;
    })) << to_string(sut.frame().state);
    EXPECT_LT(norm(sut.frame().tip - sut.truth().tip), 1e-3);
    EXPECT_EQ(watch.breach(), "");
  }
}

// A handle that dies costs a Falcon nothing: its firmware runs on and knows where it is, and would
// push again with nobody there.
TEST_P(Unplug, AFalconThatComesBackByItselfWaitsForItsClear) {
  ClosedLoop::Setup setup;
  sim::ScriptedFault death;
  death.kind = sim::FaultKind::Disconnect;
  death.from = MonotonicTime{std::chrono::seconds(6)};
  death.lasts = std::chrono::milliseconds(100);
  setup.cables.script.push_back(death);
  ClosedLoop sut(with({"arm.0.device=sim:falcon-loaded", "arm.hand.motion=still"}), setup);
  sut.run_until_driven();
  ArmWatch watch(sut);
  ASSERT_TRUE(sut.run_until(6, [&] { return sut.frame().state == OperatingState::Lost; }));
  run_until_calibrated(sut, watch);
  EXPECT_FALSE(sut.run_until(3, [&] {
    watch.see();
    return sut.frame().state != OperatingState::Fault;
  }));
  clear(sut);
  run_until_active(sut, watch);
  EXPECT_EQ(watch.breach(), "");
}

TEST_P(Unplug, AClearThatComesTooSoonIsRefusedAtAnyMomentOfTheCalibration) {
  ClosedLoop sut(with(kStill));
  sut.run_until_leaning();
  ArmWatch watch(sut);
  sut.unplug();
  sut.sim_arm().backend().push_tip({});
  int asked = 0;
  const auto ask = [&] {
    watch.see();
    if (sut.frame().state == OperatingState::Fault) return;
    clear(sut);  // judged by the tick after
    ++asked;
    EXPECT_NE(sut.snapshot().clear_outcome, ClearOutcome::Cleared);
  };
  sut.run(0.2, ask);
  sut.replug();
  ASSERT_TRUE(sut.run_until(8, [&] {
    ask();
    return sut.frame().state == OperatingState::Fault;
  }));
  EXPECT_GT(asked, GetParam()) << "a second of its absence, its start and its calibration";
  sut.run(0.5, [&] {
    watch.see();
    EXPECT_EQ(sut.frame().state, OperatingState::Fault);
  });
  EXPECT_EQ(watch.breach(), "");
}

// One bad contact is enough: reports that stop for a moment, or for so long that it forgets. An arm
// of the text protocol that forgets has to be switched off and on: it is spared that.
TEST_P(Unplug, OneThatFallsSilentAgainAndAgainIsClearedLastAllTheSame) {
  for (const auto& [device, longest_ms] :
       {std::pair("sim:phantom-vintage", 600), std::pair("sim:phantom-vintage-serial", 90)}) {
    SCOPED_TRACE(device);
    ClosedLoop::Setup setup;
    sim::ScriptedFault silence;
    silence.kind = sim::FaultKind::DropIn;
    for (int i = 0; i < 12; ++i) {
      silence.from = MonotonicTime{std::chrono::milliseconds(10'100 + 470 * i)};
      silence.lasts = std::chrono::milliseconds(i % 3 == 2 ? longest_ms : 25 + 60 * (i % 3));
      setup.cables.script.push_back(silence);
    }
    ClosedLoop sut(with({std::string("arm.0.device=") + device, "arm.hand.motion=still"}), setup);
    sut.run_until_driven();
    ArmWatch watch(sut);
    const MonotonicTime pulled{std::chrono::seconds(10)};
    ASSERT_LT(sut.now(), pulled);
    ASSERT_TRUE(sut.run_until(10, [&] { return sut.now() >= pulled; }));
    sut.unplug();
    sut.run(0.05, [&] { watch.see(); });
    sut.replug();
    int refused = 0;
    sut.run(10, [&] {
      watch.see();
      EXPECT_EQ(norm(sut.frame().force), 0);
      EXPECT_NE(sut.frame().state, OperatingState::Active);
      if (sut.frame().calibration == CalibrationState::Ok) return;
      clear(sut);  // judged by the tick after
      ++refused;
      EXPECT_NE(sut.snapshot().clear_outcome, ClearOutcome::Cleared);
    });
    EXPECT_GT(refused, GetParam());
    run_until_calibrated(sut, watch);
    clear(sut);
    run_until_active(sut, watch);
    EXPECT_EQ(watch.breach(), "");
  }
}

TEST_P(Unplug, PulledAgainAtAnyMomentOfTheCalibrationItIsOneFaultAndOneClear) {
  ClosedLoop sut(with(kStill));
  sut.run_until_driven();
  ArmWatch watch(sut);
  for (const double s : {0.0, 0.1, 0.57, 1.1, 1.3, 3.0}) {
    sut.run(s, [&] { watch.see(); });
    EXPECT_NE(sut.frame().state == OperatingState::Active, s > 0);
    sut.unplug();
    sut.run(0.05, [&] { watch.see(); });
    sut.replug();
  }
  run_until_calibrated(sut, watch);
  EXPECT_EQ(sut.snapshot().faults, 1U);
  clear(sut);
  run_until_active(sut, watch);
  EXPECT_EQ(watch.breach(), "");
}

TEST_P(Unplug, AnArmThatRestsWhenItIsPulledNeedsNoClear) {
  ClosedLoop sut(with(kStill));
  sut.run_until_driven();
  ArmWatch watch(sut);
  sut.controls().want_active = false;
  sut.run(0.1, [&] { watch.see(); });
  ASSERT_EQ(sut.frame().state, OperatingState::Inactive);
  sut.unplug();
  sut.run(0.1, [&] { watch.see(); });
  sut.replug();
  sut.controls().want_active = true;
  run_until_active(sut, watch);
  EXPECT_EQ(sut.snapshot().faults, 0U);
  EXPECT_EQ(watch.breach(), "");
}

// The forces of the left arm, tick by tick, while `happening` befalls the right one.
std::vector<Force3> felt_beside(const std::vector<std::string>& overrides,
                                const std::function<void(ClosedLoop&, int tick)>& happening) {
  ClosedLoop::Setup setup;
  setup.text = test::kTwoExplorers;
  ClosedLoop sut(overrides, setup);
  ArmWatch beside(sut, 1);
  std::vector<Force3> forces;
  int tick = 0;
  sut.run(9, [&] {
    beside.see();
    forces.push_back(sut.frame(1).force);
    happening(sut, ++tick);
  });
  EXPECT_EQ(beside.breach(), "");
  EXPECT_EQ(sut.frame(1).state, OperatingState::Active);
  EXPECT_EQ(sut.snapshot(1).faults, 0U);
  return forces;
}

TEST_P(Unplug, TheArmBesideFeelsTheSameToTheBitUntilAllIsWellAgain) {
  const std::vector<Force3> alone = felt_beside(with(), [](ClosedLoop&, int) {});
  bool was_cleared = false;
  const auto pulled_and_cleared = [&](ClosedLoop& loop, int tick) {
    if (tick == 3 * GetParam()) loop.unplug();
    if (tick == 4 * GetParam()) loop.replug();
    const bool is_calibrated = loop.frame().state == OperatingState::Fault;
    if (is_calibrated && !was_cleared) clear(loop);
    was_cleared = was_cleared || is_calibrated;
    if (tick == 9 * GetParam()) {
      EXPECT_EQ(loop.frame().state, OperatingState::Active);
    }
  };
  EXPECT_TRUE(felt_beside(with(), pulled_and_cleared) == alone);
  EXPECT_TRUE(was_cleared);
}

TEST_P(Unplug, AFaultThatLatchedBeforeOutlivesTheReturn) {
  ClosedLoop sut(with(kStill));
  sut.run_until_leaning();
  ArmWatch watch(sut);
  sut.controls().is_estop_healthy = false;
  sut.tick();
  sut.controls().is_estop_healthy = true;
  sut.sim_arm().backend().push_tip({});
  sut.unplug();
  sut.run(0.1, [&] { watch.see(); });
  EXPECT_EQ(sut.frame().state, OperatingState::Lost);
  sut.replug();
  sut.run(4, [&] { watch.see(); });
  EXPECT_EQ(sut.frame().state, OperatingState::Fault);
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::Estop);
  sut.controls().request_clear(sut.snapshot().fault.number);
  run_until_active(sut, watch);
  EXPECT_EQ(watch.breach(), "");
}

}  // namespace
}  // namespace thimble
