// What goes wrong between the unplug of an arm that was driven and its clear (decision 0485).
#include "tests/unit/servo/servo_return.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace thimble::servo {
namespace {

TEST_F(ServoReturn, OneThatSaysNothingBeforeItIsCalibratedIsWaitedForAndClearedLast) {
  lose();
  put_back();
  for (const int silent_ticks : {25, 5000}) {
    rig.device.next_status = IoStatus::NoData;
    rig.tick(silent_ticks);
    EXPECT_EQ(rig.state(), OperatingState::Calibrating);
    EXPECT_EQ(clear(), ClearOutcome::NotLatched);
    rig.device.next_status = IoStatus::Ok;
    rig.tick(10);
  }
  expect_it_is_cleared_last();
}

TEST_F(ServoReturn, AnEstopBeforeItIsCalibratedStopsItAndItIsClearedLastAllTheSame) {
  lose();
  put_back();
  rig.controls.is_estop_healthy = false;
  rig.tick(500);
  EXPECT_EQ(rig.state(), OperatingState::Fault);
  EXPECT_EQ(rig.snapshot().fault.code, FaultCode::Disconnected) << "the first stays";
  EXPECT_EQ(clear(), ClearOutcome::InputUnhealthy);
  rig.controls.is_estop_healthy = true;
  EXPECT_EQ(clear(), ClearOutcome::NotLatched);
  rig.tick();
  EXPECT_EQ(rig.state(), OperatingState::Calibrating);
  expect_it_is_cleared_last();
}

// Silence would cost it its reference unseen: an arm that is not asked does not say so.
TEST_F(ServoReturn, AnEstopWhileItWaitsForItsClearCostsItNoReference) {
  lose();
  put_back();
  calibrate();
  rig.controls.is_estop_healthy = false;
  rig.device.written.clear();
  rig.tick(1000);
  EXPECT_EQ(rig.device.written.size(), 1000U);
  EXPECT_EQ(clear(), ClearOutcome::InputUnhealthy);
  rig.controls.is_estop_healthy = true;
  rig.tick(5);
  EXPECT_EQ(rig.state(), OperatingState::Fault);
  expect_nothing_pushed();
  EXPECT_EQ(clear(), ClearOutcome::Cleared);
}

TEST_F(ServoReturn, AReferenceThatIsLostWhileItWaitsIsGivenAgainBeforeTheClear) {
  lose();
  put_back();
  calibrate();
  ASSERT_EQ(rig.state(), OperatingState::Fault);
  rig.device.state.calibration = CalibrationState::NeedsUser;
  EXPECT_EQ(clear(), ClearOutcome::NotLatched) << "in the very tick";
  EXPECT_EQ(rig.state(), OperatingState::Calibrating);
  EXPECT_EQ(clear(), ClearOutcome::NotLatched);
  expect_it_is_cleared_last();
}

// What it says when it speaks again may be that it has forgotten.
TEST_F(ServoReturn, OneThatIsCalibratedAndSaysNothingIsNotCleared) {
  lose();
  put_back();
  calibrate();
  rig.device.next_status = IoStatus::NoData;
  rig.tick(25);
  EXPECT_FALSE(rig.snapshot().is_place_known);
  EXPECT_EQ(clear(), ClearOutcome::NotLatched);
  rig.device.next_status = IoStatus::Ok;
  rig.tick();
  EXPECT_TRUE(rig.snapshot().is_place_known);
  EXPECT_EQ(clear(), ClearOutcome::Cleared);
}

TEST_F(ServoReturn, AClearInTheTickThatLosesItAgainIsRefused) {
  lose();
  put_back();
  calibrate();
  rig.device.next_status = IoStatus::Disconnected;
  EXPECT_EQ(clear(), ClearOutcome::NotLatched);
  EXPECT_EQ(rig.state(), OperatingState::Lost);
  EXPECT_EQ(rig.snapshot().fault.number, 1U);
  put_back();
  expect_it_is_cleared_last();
}

// A host may learn late of a cable: transfers fail at once, the hub says why some time after.
TEST_F(ServoReturn, OneThatFellSilentBeforeItIsLostIsOneFaultAndIsClearedLastToo) {
  rig.device.next_status = IoStatus::NoData;
  rig.tick(30);
  ASSERT_EQ(rig.state(), OperatingState::Fault);
  lose();
  EXPECT_EQ(rig.snapshot().fault.code, FaultCode::StaleSample);
  EXPECT_EQ(rig.snapshot().faults, 1U);
  EXPECT_EQ(rig.sut.recorder().take().cause.code, FaultCode::StaleSample);
  EXPECT_EQ(rig.sut.recorder().take().cause.code, FaultCode::Disconnected) << "beside it";
  EXPECT_FALSE(rig.sut.recorder().is_frozen());
  put_back();
  ASSERT_EQ(rig.state(), OperatingState::Calibrating);
  expect_it_is_cleared_last();
}

TEST_F(ServoReturn, AnEstopInTheTickThatLosesItIsTheFirstFault) {
  rig.controls.is_estop_healthy = false;
  lose();
  EXPECT_EQ(rig.snapshot().fault.code, FaultCode::Estop);
  EXPECT_EQ(rig.snapshot().faults, 1U);
  rig.controls.is_estop_healthy = true;
  put_back();
  expect_it_is_cleared_last();
}

TEST_F(ServoReturn, APlaceThatIsNoneInItsFirstSampleIsAFaultInThatTick) {
  for (const bool was_driven : {true, false}) {
    if (!was_driven) {
      rig.controls.want_active = false;
      rig.tick(1000);
      ASSERT_EQ(rig.state(), OperatingState::Inactive);
    }
    lose();
    const Position3 place = rig.device.state.tip;
    rig.device.state.tip = {std::numeric_limits<double>::quiet_NaN(), 0, 0};
    rig.device.next_status = IoStatus::Ok;
    rig.tick();
    EXPECT_EQ(rig.state(), OperatingState::Fault) << was_driven;
    EXPECT_EQ(rig.snapshot().fault.code,
              was_driven ? FaultCode::Disconnected : FaultCode::NonFiniteState);
    rig.device.state.tip = place;
    if (!was_driven) break;
    put_back();
    expect_it_is_cleared_last();
  }
}

}  // namespace
}  // namespace thimble::servo
