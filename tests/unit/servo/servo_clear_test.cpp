#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "tests/unit/servo/scripted_rig.hpp"

namespace thimble::servo {
namespace {

struct ServoClear : testing::Test {
  ServoClear() { rig.activate_fully(); }
  ServoRig rig;
};

TEST_F(ServoClear, AClearWhileTheEstopIsPressedDoesNothing) {
  rig.controls.is_estop_healthy = false;
  rig.tick();
  rig.controls.request_clear(rig.snapshot().fault.number);
  rig.tick(5);
  rig.controls.is_estop_healthy = true;
  rig.tick(5);
  EXPECT_EQ(rig.state(), OperatingState::Fault);
}

TEST_F(ServoClear, AClearOfTheTickAfterTheFaultIsTakenAndAnswered) {
  rig.press_estop();
  const std::uint32_t id = rig.controls.request_clear(rig.snapshot().fault.number);
  rig.tick();
  EXPECT_EQ(rig.snapshot().clear_answered, id);
  EXPECT_EQ(rig.snapshot().clear_outcome, ClearOutcome::Cleared);
  EXPECT_NE(rig.state(), OperatingState::Fault);
}

TEST_F(ServoClear, AClearIsForTheFaultThatItNamesAndNoOther) {
  for (int round = 1; round <= 3; ++round) {
    // Asked for while nothing is latched, and for a fault that is over.
    const std::uint32_t old = rig.snapshot().fault.number;
    const std::uint32_t early = rig.controls.request_clear(static_cast<std::uint32_t>(round - 1));
    rig.tick();
    EXPECT_EQ(old, 0U);
    EXPECT_EQ(rig.snapshot().clear_answered, early);
    EXPECT_EQ(rig.snapshot().clear_outcome, ClearOutcome::NotLatched);
    rig.press_estop();
    rig.controls.request_clear(static_cast<std::uint32_t>(round - 1));
    rig.tick(5);
    EXPECT_EQ(rig.state(), OperatingState::Fault) << "that was for the fault before";
    EXPECT_EQ(rig.snapshot().clear_outcome, ClearOutcome::NotLatched);
    rig.controls.request_clear(static_cast<std::uint32_t>(round));
    rig.tick(5);
    EXPECT_EQ(rig.state(), OperatingState::Active);
  }
}

TEST_F(ServoClear, ANumberThatWasGuessedClearsNoFaultOfItsOwnTick) {
  rig.device.state.tip.x = std::numeric_limits<double>::quiet_NaN();
  rig.controls.request_clear(1);
  rig.tick();
  EXPECT_EQ(rig.state(), OperatingState::Fault);
  EXPECT_EQ(rig.snapshot().clear_outcome, ClearOutcome::NotLatched);
  EXPECT_EQ(rig.snapshot().faults, 1U);
}

// Requests at random moments, the oracle: a fault ends only by a request that names it, made
// since it latched, judged with a healthy input.
TEST_F(ServoClear, RandomClearsNeverEndAFaultThatTheyDoNotName) {
  std::mt19937 random(6);
  int cleared = 0;
  for (int step = 0; step < 20'000; ++step) {
    const ServoSnapshot before = rig.snapshot();
    rig.controls.is_estop_healthy = random() % 4 != 0;
    const bool is_asked = random() % 3 == 0;
    const std::uint32_t named = before.fault.number - random() % 2;
    if (is_asked) rig.controls.request_clear(named);
    rig.tick();
    if (before.frame.state != OperatingState::Fault) continue;
    const bool must_clear =
        is_asked && named == before.fault.number && rig.controls.is_estop_healthy;
    ASSERT_EQ(rig.state() != OperatingState::Fault, must_clear) << step;
    cleared += must_clear ? 1 : 0;
  }
  EXPECT_GT(cleared, 1000);
}

TEST_F(ServoClear, AClearOfALostArmIsRefusedAndDoesNotLieInWait) {
  rig.press_estop();
  rig.device.next_status = IoStatus::Disconnected;
  rig.tick();
  ASSERT_EQ(rig.state(), OperatingState::Lost);
  rig.controls.request_clear(1);
  rig.tick();
  EXPECT_EQ(rig.snapshot().clear_outcome, ClearOutcome::NotLatched);
  rig.device.next_status = IoStatus::Ok;
  rig.tick(5);
  EXPECT_EQ(rig.state(), OperatingState::Fault);
}

}  // namespace
}  // namespace thimble::servo
