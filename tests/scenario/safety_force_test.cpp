#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/scenario/at_each_rate.hpp"
#include "tests/support/arm_watch.hpp"

namespace thimble {
namespace {

using test::ArmWatch;
using test::ClosedLoop;

// A wall far too hard for any arm and a hand that leans on it: the force asked for jumps
// between nothing and many times the limit.
const std::vector<std::string> kViolentWall{
    "arm.coupling.stiffness_newton_per_m=20000", "arm.hand.motion=explore", "arm.hand.reach_m=0.03",
    "arm.hand.stiffness_newton_per_m=1500", "arm.hand.damping_newton_s_per_m=20"};

std::vector<std::string> violent_and(std::vector<std::string> more) {
  more.insert(more.end(), kViolentWall.begin(), kViolentWall.end());
  return more;
}

class SafetyForce : public test::AtEachRate {};
THIMBLE_AT_EACH_RATE(SafetyForce);

TEST_P(SafetyForce, StaysBelowThePeakOfTheArmWhateverTheWallAsks) {
  ClosedLoop sut(with(violent_and({"arm.amplifier_max_a=6"})));
  ArmWatch watch(sut);
  sut.run(6, [&] { watch.see(); });
  EXPECT_EQ(watch.breach(), "");
  EXPECT_GT(watch.peak_sent_newton(), 4.9) << "the limit of 5 N was never asked for";
  EXPECT_GT(watch.peak_motor_newton(), 4.5);
  EXPECT_GT(watch.peak_rise(), 990) << "the limit of the rise was never asked for";
}

TEST_P(SafetyForce, StaysBelowAConfiguredLimitAtTheArm) {
  ClosedLoop sut(with(violent_and({"arm.limits.force_newton=1.5"})));
  ArmWatch watch(sut);
  sut.run(6, [&] { watch.see(); });
  EXPECT_EQ(watch.breach(), "");
  EXPECT_GT(watch.peak_sent_newton(), 1.49);
  EXPECT_LT(watch.peak_motor_newton(), 1.6);
}

TEST_P(SafetyForce, NoMotorGetsMoreThanItsAmplifierMayGive) {
  ClosedLoop sut(with(violent_and({"arm.amplifier_max_a=0.6"})));
  ArmWatch watch(sut);
  sut.run(6, [&] { watch.see(); });
  EXPECT_EQ(watch.breach(), "");
  EXPECT_GT(watch.peak_motor_a(), 0.59) << "the limit of the current was never asked for";
  EXPECT_LE(watch.peak_motor_a(), 0.601);
  EXPECT_LT(watch.peak_sent_newton(), 4.9) << "the norm would have done it";
}

TEST_P(SafetyForce, RisesNoFasterThanConfigured) {
  ClosedLoop sut(with(violent_and({"arm.limits.rise_newton_per_s=100"})));
  ArmWatch watch(sut);
  sut.run(4, [&] { watch.see(); });
  EXPECT_EQ(watch.breach(), "");
  EXPECT_GT(watch.peak_rise(), 99);
}

// The hand leans on the wall before the arm is activated.
TEST_P(SafetyForce, ActivationRampsFromNothingToFullInHalfASecond) {
  ClosedLoop sut(with({"arm.activate=false", "arm.hand.motion=poke", "arm.hand.reach_m=0.03"}));
  ASSERT_TRUE(sut.run_until(5, [&] { return sut.frame().tip.x > 0.02; }));
  ArmWatch watch(sut);
  const MonotonicTime activated = sut.now();
  sut.controls().want_active = true;
  MonotonicTime full{};
  sut.run(0.7, [&] {
    watch.see();
    const servo::ServoFrame& frame = sut.frame();
    const double since_s = seconds(frame.now - activated);
    EXPECT_NEAR(frame.gain, std::min(1.0, since_s / 0.5), 0.009) << since_s;
    if (frame.gain >= 1 && full == MonotonicTime{}) full = frame.now;
  });
  EXPECT_EQ(watch.breach(), "");
  EXPECT_NEAR(seconds(full - activated), 0.5, 0.005);
  // Of a force asked for all along, at the start only its small share reaches the motors.
  EXPECT_GT(watch.peak_motor_newton(), 0.2);
}

TEST_P(SafetyForce, ATipThatOutrunsTheLimitStopsTheArm) {
  ClosedLoop sut(with({"arm.hand.motion=still"}));
  sut.run_until_driven();
  ArmWatch watch(sut);
  // Nobody can hold on to an arm that is thrown: 0.35 kg at the tip, 40 N.
  sut.sim_arm().backend().push_tip({60, 0, 0});
  double fastest_m_per_s = 0;
  ASSERT_TRUE(sut.run_until(0.2, [&] {
    watch.see();
    fastest_m_per_s = std::max(fastest_m_per_s, norm(sut.truth().tip_velocity));
    return sut.frame().state == OperatingState::Fault;
  }));
  sut.sim_arm().backend().push_tip({});
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::Overspeed);
  EXPECT_GT(fastest_m_per_s, 1.5);
  EXPECT_EQ(norm(sut.frame().force), 0);
  sut.run(0.1, [&] { watch.see(); });
  EXPECT_EQ(watch.breach(), "");
  EXPECT_EQ(norm(sut.truth().motor_force), 0);
}

TEST_P(SafetyForce, AFastHandBelowTheLimitIsNoFault) {
  ClosedLoop sut(with({"arm.hand.motion=sweep", "arm.hand.stiffness_newton_per_m=1500"}));
  sut.run(8);
  EXPECT_EQ(sut.snapshot().faults, 0U);
  EXPECT_GT(sut.snapshot().total_contacts, 0U);
}

// The limit of the motors' heat: 28.6 mN·m of continuous torque over 16.3 mN·m/A, as the model
// table has it for this arm.
constexpr double kContinuous_a = 1.75;

double hottest_a(ClosedLoop& sut) {
  double peak_a = 0;
  for (const double current_a : sut.truth().motor_current_a) {
    peak_a = std::max(peak_a, std::abs(current_a));
  }
  return peak_a;
}

TEST(SafetyHeat, AMotorThatIsLeanedOnForLongFallsToItsContinuousCurrent) {
  ClosedLoop sut({"arm.hand.motion=still"});
  sut.run_until_driven();
  ArmWatch watch(sut);
  sut.sim_arm().backend().push_tip({8, 0, 0});

  double early_a = 0;
  sut.run(3, [&] {
    watch.see();
    early_a = std::max(early_a, hottest_a(sut));
  });
  sut.run(60, [&] { watch.see(); });
  double late_a = 0;
  sut.run(2, [&] { late_a = std::max(late_a, hottest_a(sut)); });

  EXPECT_EQ(watch.breach(), "");
  EXPECT_GT(early_a, 1.2 * kContinuous_a) << "a cold motor may give its peak";
  EXPECT_LT(late_a, 1.1 * kContinuous_a);
  EXPECT_GT(late_a, 0.8 * kContinuous_a) << "and no less than it can bear";
  EXPECT_EQ(sut.frame().state, OperatingState::Active) << "hot is no fault";
}

}  // namespace
}  // namespace thimble
