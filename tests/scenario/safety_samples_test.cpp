#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>

#include "tests/scenario/at_each_rate.hpp"
#include "tests/support/arm_watch.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using test::ArmWatch;
using test::ClosedLoop;

const std::vector<std::string> kStill{"arm.hand.motion=still"};

// Well after the arm leans on the wall; virtual time makes every run the same.
constexpr MonotonicTime kTrouble{milliseconds(3000)};

sim::ScriptedFault stall(MonotonicTime from, Duration lasts) {
  sim::ScriptedFault fault;
  fault.kind = sim::FaultKind::Stall;
  fault.from = from;
  fault.lasts = lasts;
  return fault;
}

ClosedLoop::Setup cables_that(std::vector<sim::ScriptedFault> script) {
  ClosedLoop::Setup setup;
  setup.cables.script = std::move(script);
  return setup;
}

class SafetySamples : public test::AtEachRate {
 protected:
  static void run_until_trouble(ClosedLoop& loop) {
    loop.run_until_leaning();
    ASSERT_LT(loop.now(), kTrouble);
    ASSERT_TRUE(
        loop.run_until(3, [&] { return loop.now() + loop.settings().period() > kTrouble; }));
    ASSERT_GT(norm(loop.frame().force), 1);
  }
};
THIMBLE_AT_EACH_RATE(SafetySamples);

TEST_P(SafetySamples, AnOutageIsHeldForThreeMillisecondsThenRampsAndEndsWithoutAJump) {
  ClosedLoop sut(with(kStill), cables_that({stall(kTrouble, milliseconds(12))}));
  run_until_trouble(sut);
  ArmWatch watch(sut);
  const Force3 before = sut.frame().force;
  Duration oldest{};
  while (sut.now() < kTrouble + milliseconds(12)) {
    sut.tick();
    watch.see();
    const servo::ServoFrame& frame = sut.frame();
    oldest = std::max(oldest, frame.sample_age);
    const double gone = (seconds(frame.sample_age) - 0.003) / 0.020;
    const double expected = std::clamp(1.0 - gone, 0.0, 1.0);
    EXPECT_NEAR(norm(frame.force), expected * norm(before), 0.05) << seconds(frame.sample_age);
    EXPECT_EQ(frame.is_stale, frame.sample_age > milliseconds(3));
  }
  EXPECT_GT(oldest, milliseconds(8)) << "the outage never came";
  double largest_newton = 0;
  sut.run(0.006, [&] {
    watch.see();
    if (!sut.frame().is_stale) largest_newton = std::max(largest_newton, norm(sut.frame().force));
  });
  EXPECT_LT(largest_newton, norm(before) + 0.1) << "the ghost restarts at the hand";
  sut.run(1, [&] { watch.see(); });
  EXPECT_EQ(watch.breach(), "");
  EXPECT_EQ(sut.snapshot().faults, 0U);
  EXPECT_EQ(sut.frame().state, OperatingState::Active);
  EXPECT_TRUE(sut.frame().is_in_contact) << "the wall is felt again";
}

TEST_P(SafetySamples, TwentyMillisecondsWithoutASampleFault) {
  ClosedLoop sut(with(kStill), cables_that({stall(kTrouble, milliseconds(30))}));
  run_until_trouble(sut);
  ArmWatch watch(sut);
  ASSERT_TRUE(sut.run_until(0.03, [&] { return sut.frame().state == OperatingState::Fault; }));
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::StaleSample);
  EXPECT_GE(sut.frame().sample_age, milliseconds(20));
  EXPECT_LT(sut.frame().sample_age, milliseconds(20) + sut.settings().period());
  EXPECT_EQ(norm(sut.frame().force), 0);
  ASSERT_TRUE(sut.run_until(1, [&] { return sut.now() > kTrouble + milliseconds(35); }));
  EXPECT_EQ(norm(sut.truth().motor_force), 0) << "the zero waits behind the outage";
  EXPECT_GT(sut.snapshot().missed_exchanges, test::exchanges_within(milliseconds(15), sut));
}

TEST_P(SafetySamples, RepeatedOutagesFillTheBucketThoughEachIsShort) {
  std::vector<sim::ScriptedFault> outages;
  for (int i = 0; i < 20; ++i) {
    outages.push_back(stall(kTrouble + milliseconds(14 * i), milliseconds(10)));
  }
  ClosedLoop sut(with(kStill), cables_that(outages));
  run_until_trouble(sut);
  ArmWatch watch(sut);
  ASSERT_TRUE(sut.run_until(0.28, [&] {
    watch.see();
    return sut.frame().state == OperatingState::Fault;
  }));
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::MissedExchanges);
  EXPECT_GT(sut.now(), kTrouble + milliseconds(15)) << "not by the first one";
  EXPECT_EQ(watch.breach(), "");
}

TEST_P(SafetySamples, SingleLostReportsAreHarmless) {
  ClosedLoop::Setup setup;
  setup.cables.seed = 3;
  setup.cables.random.drop_in = 0.05;
  setup.cables.random.drop_out = 0.02;
  ClosedLoop sut(with({"arm.hand.seed=4"}), setup);
  ArmWatch watch(sut);
  sut.run(6, [&] { watch.see(); });
  EXPECT_EQ(watch.breach(), "");
  EXPECT_EQ(sut.snapshot().faults, 0U);
  EXPECT_EQ(sut.frame().state, OperatingState::Active);
  EXPECT_GT(sut.snapshot().total_contacts, 3U);
}

TEST_P(SafetySamples, SpoiltReportsNeverBecomeForces) {
  ClosedLoop::Setup setup;
  setup.cables.seed = 5;
  setup.cables.random.corrupt_in = 0.02;
  setup.cables.random.truncate_in = 0.02;
  ClosedLoop sut(with({}), setup);
  ArmWatch watch(sut);
  sut.run(6, [&] { watch.see(); });
  EXPECT_EQ(watch.breach(), "");
  EXPECT_GT(sut.snapshot().protocol_errors, 0U);
}

}  // namespace
}  // namespace thimble
