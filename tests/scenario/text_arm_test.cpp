#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "drivers/phantom/text_wire.hpp"
#include "tests/scenario/at_each_rate.hpp"
#include "tests/scenario/two_explorers.hpp"
#include "tests/support/arm_watch.hpp"
#include "tests/support/closed_loop.hpp"

// Arms behind a Teensy that speaks text over USB serial: the same person, servo and wall, and what
// can go wrong with a line. One test a trouble: what the person reads, what the arm does.
namespace thimble {
namespace {

using test::ArmWatch;
using test::ClosedLoop;

constexpr const char* kVintage = "arm.0.device=sim:phantom-vintage-serial";
const std::vector<std::string> kStill{kVintage, "arm.hand.motion=still"};

class TextArm : public test::AtEachRate {};
THIMBLE_AT_EACH_RATE(TextArm);

sim::FaultPlan plan_from(sim::FaultKind kind, MonotonicTime from, Duration lasts) {
  sim::ScriptedFault fault;
  fault.kind = kind;
  fault.from = from;
  fault.lasts = lasts;
  sim::FaultPlan plan;
  plan.script.push_back(fault);
  return plan;
}

// When an arm of run_until_leaning() has been leaning for a while, and the plan begins.
constexpr MonotonicTime kTrouble{std::chrono::seconds(5)};

void run_until(ClosedLoop& sut, MonotonicTime t) {
  while (sut.now() < t) sut.tick();
}

// Its person calibrates it, within 6 s.
bool becomes_active(ClosedLoop& sut, ArmWatch& watch) {
  return sut.run_until(6, [&] {
    watch.see();
    return sut.frame().state == OperatingState::Active;
  });
}

TEST_P(TextArm, IsCalibratedByItsPersonFeelsTheWallAndLetsGoToZero) {
  for (const char* arm : {kVintage, "arm.0.device=sim:woody-2015-serial"}) {
    ClosedLoop sut(with({arm, "arm.hand.motion=still"}));
    ArmWatch watch(sut);
    bool was_asked = false;
    ASSERT_TRUE(sut.run_until(
        6,
        [&] {
          watch.see();
          was_asked = was_asked ||
                      sut.instruction().find("press the calibration button") != std::string::npos;
          return sut.frame().gain >= 1;
        }))
        << to_string(sut.frame().state) << ": " << sut.instruction();
    EXPECT_TRUE(was_asked);
    EXPECT_LT(norm(sut.frame().tip - sut.truth().tip), 1e-3) << "driver and arm agree on the pose";

    sut.sim_arm().backend().push_tip({4.5, 0, 0});
    sut.run(0.6, [&] { watch.see(); });
    EXPECT_TRUE(sut.frame().is_in_contact);
    EXPECT_GT(norm(sut.frame().force), 1) << "of a wall, or of the edge where a woody stands";
    EXPECT_NEAR(norm(sut.frame().force - sut.truth().motor_force), 0, 0.3);

    sut.controls().want_active = false;
    ASSERT_TRUE(sut.run_until(0.5, [&] {
      watch.see();
      return sut.frame().state == OperatingState::Inactive;
    }));
    sut.run(0.02, [&] { watch.see(); });
    EXPECT_EQ(norm(sut.truth().motor_force), 0);
    EXPECT_EQ(sut.snapshot().fault.code, FaultCode::None);
    EXPECT_EQ(watch.breach(), "");
  }
}

TEST_P(TextArm, ExploringTheBoxBreaksNoRule) {
  ClosedLoop sut(with({kVintage}));
  ArmWatch watch(sut);
  sut.run(10, [&] { watch.see(); });
  EXPECT_EQ(watch.breach(), "");
  EXPECT_EQ(sut.frame().state, OperatingState::Active);
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::None);
  EXPECT_GT(sut.snapshot().total_contacts, 0U);
}

// The build makes up a counter and echoes another until its button is pressed.
TEST_P(TextArm, CountersThatAreMadeUpAreNoReference) {
  ClosedLoop sut(with(kStill));
  sut.sim_arm().backend().hold_tip(nullptr);  // nobody presses anything
  sut.run(20, [&] {
    ASSERT_NE(sut.frame().state, OperatingState::Active);
    ASSERT_NE(sut.frame().calibration, CalibrationState::Ok);
    ASSERT_EQ(norm(sut.truth().motor_force), 0);
  });
  EXPECT_NE(sut.instruction().find("press the calibration button"), std::string::npos);
}

TEST_P(TextArm, UnpluggedItStopsAndOnReturnIsCalibratedAgainAndCleared) {
  ClosedLoop sut(with(kStill));
  sut.run_until_leaning();
  ArmWatch watch(sut);
  sut.unplug();
  sut.tick();
  EXPECT_EQ(sut.frame().state, OperatingState::Lost);
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::Disconnected);
  sut.run(0.3, [&] { watch.see(); });
  EXPECT_EQ(norm(sut.truth().motor_force), 0);
  sut.sim_arm().backend().push_tip({});
  sut.replug();
  ASSERT_TRUE(sut.run_until(6,
                            [&] {
                              watch.see();
                              return sut.frame().state == OperatingState::Fault;
                            }))
      << to_string(sut.frame().state) << ": " << sut.instruction();
  sut.controls().request_clear(sut.snapshot().fault.number);
  ASSERT_TRUE(becomes_active(sut, watch))
      << to_string(sut.frame().state) << ": " << sut.instruction();
  EXPECT_LT(norm(sut.frame().tip - sut.truth().tip), 1e-3) << "the new reference is right";
  EXPECT_EQ(watch.breach(), "");
}

TEST_P(TextArm, APortThatDiesStopsIt) {
  ClosedLoop::Setup setup;
  setup.cables = plan_from(sim::FaultKind::Disconnect, kTrouble, std::chrono::hours(1));
  ClosedLoop sut(with(kStill), setup);
  sut.run_until_leaning();
  ArmWatch watch(sut);
  run_until(sut, kTrouble);
  EXPECT_EQ(watch.breach(), "");
  sut.run(0.05);
  EXPECT_EQ(sut.frame().state, OperatingState::Lost);
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::Disconnected);
  EXPECT_EQ(norm(sut.frame().force), 0);
  EXPECT_GT(norm(sut.truth().motor_force), 1) << "nobody reaches it; a guard would, sooner";
  sut.run(seconds(phantom::text::kWatchdog));
  EXPECT_EQ(norm(sut.truth().motor_force), 0) << "its own watchdog";
  EXPECT_FALSE(sut.truth().is_amplifier_on);
  sut.run(0.2, [&] { watch.see(); });
  EXPECT_EQ(watch.breach(), "");
}

// Its counters go on, but the button may have been pressed meanwhile, so they say nothing more.
TEST_P(TextArm, SilentForLongerThanItsWatchdogItIsStoppedAndWantsItsPersonAgain) {
  ClosedLoop::Setup setup;
  setup.cables = plan_from(sim::FaultKind::Stall, kTrouble, 2 * phantom::text::kWatchdog);
  ClosedLoop sut(with(kStill), setup);
  sut.run_until_leaning();
  run_until(sut, kTrouble);
  sut.run(0.05);
  EXPECT_EQ(sut.frame().state, OperatingState::Fault);
  EXPECT_EQ(norm(sut.frame().force), 0);
  sut.run(0.06);
  EXPECT_EQ(norm(sut.truth().motor_force), 0) << "its own watchdog";
  EXPECT_FALSE(sut.truth().is_amplifier_on);
  ArmWatch watch(sut);
  sut.sim_arm().backend().push_tip({});
  sut.controls().request_clear(sut.snapshot().fault.number);
  sut.run(3, [&] {
    watch.see();
    ASSERT_NE(sut.frame().state, OperatingState::Active) << "its reference is gone";
  });
  EXPECT_EQ(watch.breach(), "");

  // The person holds it in the home pose and presses: no jump. What helps is written there.
  EXPECT_EQ(sut.frame().calibration, CalibrationState::NeedsUser);
  EXPECT_NE(sut.instruction().find("switch the controller off and on while it is away"),
            std::string::npos)
      << sut.instruction();
  sut.unplug();
  sut.sim_arm().backend().push_tip({4.5, 0, 0});
  sut.run(0.3, [&] { watch.see(); });
  sut.replug();
  sut.run(0.6, [&] { watch.see(); });
  sut.sim_arm().backend().push_tip({});
  ASSERT_TRUE(becomes_active(sut, watch))
      << to_string(sut.frame().state) << ": " << sut.instruction();
  EXPECT_LT(norm(sut.frame().tip - sut.truth().tip), 1e-3);
  EXPECT_EQ(watch.breach(), "");
}

TEST_P(TextArm, AHangingLineOfATickOrTwoIsNoFault) {
  ClosedLoop::Setup setup;
  setup.cables = plan_from(sim::FaultKind::Stall, kTrouble, std::chrono::milliseconds(5));
  ClosedLoop sut(with(kStill), setup);
  sut.run_until_leaning();
  ArmWatch watch(sut);
  run_until(sut, kTrouble);
  sut.run(0.3, [&] { watch.see(); });
  EXPECT_EQ(sut.frame().state, OperatingState::Active);
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::None);
  EXPECT_EQ(watch.breach(), "");
}

TEST_P(TextArm, GarbageNeverMovesItBeyondItsLimitsAndAFloodOfItStopsIt) {
  for (const double chance : {0.02, 1.0}) {
    ClosedLoop::Setup setup;
    setup.cables.seed = 3;
    setup.cables.random.corrupt_in = chance;
    setup.cables.random.truncate_in = chance / 4;
    ClosedLoop sut(with({kVintage}), setup);
    ArmWatch watch(sut);
    sut.run(6, [&] { watch.see(); });
    EXPECT_GT(sut.injected().of(sim::FaultKind::CorruptIn), 0U);
    EXPECT_EQ(watch.breach(), "") << chance;
    if (chance < 1) continue;
    EXPECT_NE(sut.frame().state, OperatingState::Active);
    EXPECT_EQ(norm(sut.truth().motor_force), 0);
  }
}

// What is wrong with the line of one arm, and how often: bits turned over, pieces missing, silence,
// in small doses and for good.
std::vector<sim::FaultPlan> troubles() {
  std::vector<sim::FaultPlan> plans;
  for (const double chance : {0.02, 1.0}) {
    for (double sim::RandomFaults::*kind :
         {&sim::RandomFaults::corrupt_in, &sim::RandomFaults::truncate_in,
          &sim::RandomFaults::drop_in}) {
      sim::FaultPlan plan;
      plan.seed = plans.size() + 1;
      plan.random.*kind = chance;
      plans.push_back(plan);
    }
  }
  plans.push_back(plan_from(sim::FaultKind::Stall, kTrouble, std::chrono::hours(1)));
  return plans;
}

// The forces of the arm beside, tick by tick, while both hands explore the box.
std::vector<Force3> felt_beside(const sim::FaultPlan& plan) {
  ClosedLoop::Setup setup;
  setup.text = test::kTwoExplorers;
  setup.cables = plan;
  setup.spares_others = true;
  ClosedLoop sut({"arm.0.device=sim:phantom-vintage-serial"}, setup);
  ArmWatch with_trouble(sut, 0);
  ArmWatch beside(sut, 1);
  std::vector<Force3> forces;
  sut.run(8, [&] {
    with_trouble.see();
    beside.see();
    forces.push_back(sut.frame(1).force);
  });
  // A line on which nothing passes is for the arm's own watchdog.
  const bool is_silenced = !plan.script.empty();
  EXPECT_EQ(is_silenced ? "" : with_trouble.breach(), "");
  if (is_silenced) {
    EXPECT_EQ(norm(sut.truth(0).motor_force), 0);
  }
  EXPECT_EQ(beside.breach(), "");
  EXPECT_EQ(sut.frame(1).state, OperatingState::Active);
  EXPECT_GT(sut.snapshot(1).total_contacts, 0U);
  return forces;
}

TEST(TextArmBeside, WhateverIsWrongWithALineTheOtherArmFeelsTheSameToTheBit) {
  const std::vector<Force3> expected = felt_beside({});
  ASSERT_TRUE(std::any_of(expected.begin(), expected.end(), [](Force3 f) { return norm(f) > 1; }));
  for (const sim::FaultPlan& plan : troubles()) {
    SCOPED_TRACE(plan.seed);
    EXPECT_TRUE(felt_beside(plan) == expected);
  }
}

}  // namespace
}  // namespace thimble
