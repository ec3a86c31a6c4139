#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "tests/scenario/at_each_rate.hpp"
#include "tests/support/arm_watch.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using test::ArmWatch;
using test::ClosedLoop;

const std::vector<std::string> kStill{"arm.hand.motion=still"};

// How long after the last reply the frame froze, the constraints began to fade, and were gone.
struct Silence {
  double frozen_s{-1};
  double fading_s{-1};
  double gone_s{-1};
};

Silence listen_to_silence(ClosedLoop& loop, ArmWatch& watch, double s) {
  Silence seen;
  const MonotonicTime silent_since = loop.now();
  loop.set_network_up(false);
  loop.run(s, [&] {
    watch.see();
    const servo::ServoFrame& frame = loop.frame();
    const double since_s = seconds(frame.now - silent_since);
    if (frame.is_frozen && seen.frozen_s < 0) seen.frozen_s = since_s;
    if (frame.is_fading && seen.fading_s < 0) seen.fading_s = since_s;
    if (norm(frame.force) == 0 && seen.gone_s < 0) seen.gone_s = since_s;
  });
  return seen;
}

class SafetyConstraints : public test::AtEachRate {};
THIMBLE_AT_EACH_RATE(SafetyConstraints);

TEST_P(SafetyConstraints, ASilentWorldFreezesTheFrameThenFadesAndIsFlagged) {
  ClosedLoop sut(with(kStill));
  sut.run_until_leaning();
  ArmWatch watch(sut);
  const Silence seen = listen_to_silence(sut, watch, 0.5);
  EXPECT_NEAR(seen.frozen_s, 0.020, 0.006);
  EXPECT_NEAR(seen.fading_s, 0.250, 0.006);
  EXPECT_NEAR(seen.gone_s, 0.350, 0.006);
  EXPECT_EQ(norm(sut.truth().motor_force), 0);
  EXPECT_EQ(sut.snapshot().faults, 0U) << "a silent world is no fault of the arm";
  EXPECT_EQ(sut.frame().state, OperatingState::Active);
  EXPECT_EQ(watch.breach(), "");
}

TEST_P(SafetyConstraints, AWorldThatReturnsIsFeltAgainWithoutAJump) {
  ClosedLoop sut(with(kStill));
  sut.run_until_leaning();
  ArmWatch watch(sut);
  (void)listen_to_silence(sut, watch, 0.6);
  ASSERT_GT(sut.frame().tip.x, 0.02) << "the push carried the tip through the wall";

  sut.set_network_up(true);
  double largest_step_newton = 0;
  double previous_newton = 0;
  sut.run(1, [&] {
    watch.see();
    const double newton = norm(sut.truth().motor_force);
    largest_step_newton = std::max(largest_step_newton, newton - previous_newton);
    previous_newton = newton;
  });
  EXPECT_EQ(watch.breach(), "");
  EXPECT_LT(largest_step_newton, 0.1) << "at the motors, from tick to tick";
  EXPECT_TRUE(sut.frame().is_in_contact);
  EXPECT_FALSE(sut.frame().is_fading);
  EXPECT_FALSE(sut.frame().is_frozen);
  EXPECT_GT(norm(sut.frame().offset), 0.002) << "the world came to the finger";
}

TEST_P(SafetyConstraints, AShortSilenceFadesNothing) {
  ClosedLoop sut(with(kStill));
  sut.run_until_leaning();
  ArmWatch watch(sut);
  const double before_newton = norm(sut.frame().force);
  const Silence seen = listen_to_silence(sut, watch, 0.2);
  EXPECT_GT(seen.frozen_s, 0);
  EXPECT_LT(seen.fading_s, 0);
  EXPECT_NEAR(norm(sut.frame().force), before_newton, 0.2);
  sut.set_network_up(true);
  sut.run(0.2, [&] { watch.see(); });
  EXPECT_NEAR(norm(sut.frame().force), before_newton, 0.2);
  EXPECT_EQ(watch.breach(), "");
}

// Three round trips are the floor of what a far world is given.
TEST(SafetyConstraintAge, GrowsWithTheRoundTrip) {
  for (const double delay_s : {0.05, 0.2, 0.5}) {
    ClosedLoop sut({"arm.hand.motion=still", "arm.impairment.delay_s=" + std::to_string(delay_s)});
    sut.run_until_driven();
    // Slowly, or the far wall is learned of so late that the push does not reach it any more.
    for (int i = 1; i <= 300; ++i) {
      sut.sim_arm().backend().push_tip({0.015 * i, 0, 0});
      sut.run(0.02);
    }
    ASSERT_TRUE(sut.frame().is_in_contact) << delay_s;
    ArmWatch watch(sut);
    const Silence seen = listen_to_silence(sut, watch, 2.5);
    EXPECT_NEAR(seen.frozen_s, std::max(0.02, 3 * delay_s), 0.015) << delay_s;
    EXPECT_NEAR(seen.fading_s, std::max(0.25, 3 * delay_s), 0.015) << delay_s;
    EXPECT_NEAR(seen.gone_s, seen.fading_s + 0.1, 0.004) << delay_s;
    EXPECT_EQ(watch.breach(), "");
  }
}

TEST(SafetyConstraintAge, AWorldThatNeverAnswersGivesNoForceAndIsFlagged) {
  ClosedLoop sut({"arm.impairment.loss=1"});
  sut.run_until_driven();
  sut.run(5, [&] { EXPECT_EQ(norm(sut.frame().force), 0); });
  EXPECT_TRUE(sut.frame().is_fading);
  EXPECT_TRUE(sut.frame().is_frozen);
  EXPECT_EQ(sut.frame().state, OperatingState::Active);
  EXPECT_GT(sut.arm().link_status().counters.injected.lost, 0U);
}

TEST(SafetyConstraintAge, MayBeLoosenedByTheConfiguration) {
  ClosedLoop sut({"arm.hand.motion=still", "arm.coupling.fade_after_s=1"});
  sut.run_until_leaning();
  ArmWatch watch(sut);
  const Silence seen = listen_to_silence(sut, watch, 1.3);
  EXPECT_NEAR(seen.fading_s, 1.0, 0.004);
  EXPECT_NEAR(seen.gone_s, 1.1, 0.004);
}

}  // namespace
}  // namespace thimble
