#include <gtest/gtest.h>

#include "tests/scenario/at_each_rate.hpp"
#include "tests/support/arm_watch.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using test::ArmWatch;
using test::ClosedLoop;

const std::vector<std::string> kLeaning{"arm.hand.motion=poke", "arm.hand.reach_m=0.03"};

class SafetyInputs : public test::AtEachRate {};
THIMBLE_AT_EACH_RATE(SafetyInputs);

TEST_P(SafetyInputs, AnEstopIsZeroInItsTickAndAtTheMotorsWithinFourMilliseconds) {
  ClosedLoop sut(with(kLeaning));
  sut.run_until_pressed();
  ArmWatch watch(sut);
  ASSERT_GT(norm(sut.truth().motor_force), 0.2);
  sut.controls().is_estop_healthy = false;
  sut.tick();
  EXPECT_EQ(norm(sut.frame().force), 0);
  EXPECT_EQ(sut.frame().state, OperatingState::Fault);
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::Estop);
  sut.run(0.004, [&] { watch.see(); });
  sut.run(0.2, [&] {
    watch.see();
    EXPECT_EQ(norm(sut.truth().motor_force), 0);
  });
  EXPECT_EQ(watch.breach(), "");
}

TEST_P(SafetyInputs, AReleasedDeadmanRampsToZeroWithinTwentyMillisecondsAndIsNoFault) {
  ClosedLoop sut(with(kLeaning));
  sut.run_until_pressed();
  ArmWatch watch(sut);
  const MonotonicTime released = sut.now();
  sut.controls().is_deadman_held = false;
  double previous_gain = 1;
  sut.run(0.020, [&] {
    watch.see();
    EXPECT_LT(sut.frame().gain, previous_gain) << "falls in every tick: a ramp, no step";
    EXPECT_GT(sut.frame().gain, previous_gain - 0.11);
    previous_gain = sut.frame().gain;
  });
  EXPECT_LE(sut.now() - released, milliseconds(20));
  EXPECT_NEAR(norm(sut.frame().force), 0, 1e-9);
  sut.run(0.005);
  EXPECT_EQ(norm(sut.truth().motor_force), 0);
  EXPECT_EQ(sut.snapshot().faults, 0U);

  sut.controls().is_deadman_held = true;
  const MonotonicTime held = sut.now();
  sut.run_until_driven();
  EXPECT_NEAR(seconds(sut.now() - held), 0.5, 0.005) << "force comes back by the ramp";
  EXPECT_EQ(watch.breach(), "");
}

// The pause is one like any other (decision 0083): what the hand did in it is not held against it.
TEST_P(SafetyInputs, AHandThatWentThroughAWallWhileTheDeadmanWasOpenIsNotThrownBack) {
  ClosedLoop sut(with(kLeaning));
  sut.run_until_pressed();
  ArmWatch watch(sut);
  sut.controls().is_deadman_held = false;
  sut.run(0.12, [&] { watch.see(); });
  ASSERT_GT(norm(sut.frame().wish), 2) << "what the coupling would give for how deep it went";

  sut.controls().is_deadman_held = true;
  sut.run(0.1, [&] {
    watch.see();
    EXPECT_LT(norm(sut.frame().wish), 1.2);
  });
  EXPECT_EQ(watch.breach(), "");
  EXPECT_EQ(sut.snapshot().faults, 0U);
}

TEST_P(SafetyInputs, WithdrawnActivationRampsOutAndEndsInactive) {
  ClosedLoop sut(with(kLeaning));
  sut.run_until_pressed();
  ArmWatch watch(sut);
  sut.controls().want_active = false;
  sut.run(0.030, [&] { watch.see(); });
  EXPECT_EQ(sut.frame().state, OperatingState::Inactive);
  sut.run(0.2, [&] {
    watch.see();
    EXPECT_EQ(norm(sut.truth().motor_force), 0);
  });
  EXPECT_EQ(watch.breach(), "");
  EXPECT_EQ(sut.snapshot().faults, 0U);
}

TEST_P(SafetyInputs, AServoThatIsLateNowAndThenIsCountedAndDrivesOn) {
  ClosedLoop sut(with(kLeaning));
  sut.run_until_pressed();
  ArmWatch watch(sut);
  const std::uint64_t before = sut.snapshot().overruns;
  for (int i = 0; i < 10; ++i) {
    sut.tick(milliseconds(10));
    watch.see();
    sut.run(0.1, [&] { watch.see(); });
  }
  const auto missed = static_cast<std::uint64_t>(10 * GetParam() / 100);
  EXPECT_EQ(sut.snapshot().overruns - before, missed);
  EXPECT_EQ(sut.snapshot().faults, 0U);
  EXPECT_EQ(sut.frame().state, OperatingState::Active);
  EXPECT_EQ(watch.breach(), "");
}

TEST_P(SafetyInputs, AnArmWithoutCommandForTwentyMillisecondsOfItsTimeFaults) {
  ClosedLoop sut(with(kLeaning));
  sut.run_until_pressed();
  sut.tick(milliseconds(21));
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::ServoLate);
  EXPECT_EQ(norm(sut.frame().force), 0);
  sut.run(0.005);
  EXPECT_EQ(norm(sut.truth().motor_force), 0);
}

// Of a millisecond at least: what a faster servo misses for less no arm notices.
TEST_P(SafetyInputs, WhereRealtimeIsRequiredOneMissedPeriodFaults) {
  std::vector<std::string> overrides = kLeaning;
  overrides.emplace_back("servo.realtime=required");
  ClosedLoop sut(with(overrides));
  sut.run_until_pressed();
  EXPECT_EQ(sut.snapshot().faults, 0U);
  sut.tick(std::max<Duration>(sut.settings().period(), std::chrono::milliseconds(1)));
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::ServoLate);
  EXPECT_EQ(norm(sut.frame().force), 0);
}

}  // namespace
}  // namespace thimble
