#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "tests/unit/servo/servo_return.hpp"

namespace thimble::servo {
namespace {

// It may come and go as it likes, and its recordings are half a megabyte each.
TEST(ServoUnplug, AnArmThatLeavesBeforeItWasDrivenIsLostWithoutARecording) {
  ServoRig rig;
  for (const CalibrationState seen : {CalibrationState::NeedsUser, CalibrationState::Ok}) {
    rig.device.next_status = IoStatus::Ok;
    rig.device.state.calibration = seen;
    rig.tick(100);
    ASSERT_EQ(rig.state(), seen == CalibrationState::Ok ? OperatingState::Inactive
                                                        : OperatingState::Calibrating);
    rig.device.next_status = IoStatus::Disconnected;
    rig.tick(5);
    EXPECT_EQ(rig.state(), OperatingState::Lost);
    EXPECT_EQ(rig.snapshot().fault.code, FaultCode::Disconnected);
    EXPECT_FALSE(rig.sut.recorder().is_frozen());
  }
}

TEST(ServoUnplug, AnArmThatWasDrivenAndLeftIsRecordedOnceHoweverOftenItComesAgain) {
  ServoRig rig;
  rig.activate_fully();
  for (int i = 0; i < 3; ++i) {
    rig.device.next_status = IoStatus::Disconnected;
    rig.tick(5);
    rig.device.next_status = IoStatus::Ok;
    rig.device.state.calibration = CalibrationState::NeedsUser;
    rig.tick(5);
  }
  const FlightStop stop = rig.sut.recorder().take();
  EXPECT_EQ(stop.cause.code, FaultCode::Disconnected);
  EXPECT_EQ(stop.without_room, 0U);
  EXPECT_FALSE(rig.sut.recorder().is_frozen());
}

TEST_F(ServoReturn, TheFaultIsLatchedInTheTickThatLosesTheArmAndItsRecordingIsOfThatFault) {
  rig.device.next_status = IoStatus::Disconnected;
  rig.tick();
  const ServoSnapshot lost = rig.snapshot();
  EXPECT_EQ(lost.frame.state, OperatingState::Lost);
  EXPECT_EQ(lost.frame.fault, FaultCode::Disconnected);
  EXPECT_EQ(lost.fault.number, 1U);
  EXPECT_EQ(lost.faults, 1U);
  const FlightStop stop = rig.sut.recorder().take();
  EXPECT_EQ(stop.cause.number, lost.fault.number);
  EXPECT_EQ(stop.cause.tick, lost.fault.tick);
  EXPECT_EQ(stop.frames.back().tick, lost.fault.tick);

  put_back();
  calibrate();
  EXPECT_EQ(rig.snapshot().fault.tick, lost.fault.tick) << "the same fault until it is cleared";
  EXPECT_EQ(rig.snapshot().faults, 1U);
  EXPECT_FALSE(rig.sut.recorder().is_frozen());
}

// Whoever calibrated it, and be it the arm itself in no time: it is cleared last.
TEST(ServoReturns, OneThatWasDrivenIsCalibratedThenClearedAndThenDrivenAtEveryRate) {
  for (const double rate_hz : {500.0, 1000.0, 4000.0, 8000.0}) {
    for (const double calibrated_after_s : {0.0, 0.001, 0.05, 3.0}) {
      ServoSettings settings;
      settings.rate_hz = rate_hz;
      ServoRig rig(settings);
      const auto run = [&](double s) { rig.tick(static_cast<int>(s * rate_hz)); };
      rig.coupling.wish = {4, 0, 0};
      rig.activate_fully();
      rig.device.next_status = IoStatus::Disconnected;
      run(0.1);
      rig.device.next_status = IoStatus::Ok;
      rig.device.state.calibration = CalibrationState::NeedsUser;
      rig.device.written.clear();
      run(calibrated_after_s);
      rig.device.state.calibration = CalibrationState::Ok;
      run(2);
      ASSERT_EQ(rig.state(), OperatingState::Fault) << rate_hz << ' ' << calibrated_after_s;
      ASSERT_EQ(rig.snapshot().fault.code, FaultCode::Disconnected);
      for (const Force3& force : rig.device.written) ASSERT_EQ(force, Force3{});

      rig.controls.request_clear(rig.snapshot().fault.number);
      run(0.01);
      ASSERT_EQ(rig.state(), OperatingState::Active) << rate_hz << ' ' << calibrated_after_s;
      EXPECT_LT(rig.device.written.back().x, 0.1) << "ramped from zero";
      run(1);
      EXPECT_EQ(rig.device.written.back(), (Force3{4, 0, 0}));
    }
  }
}

// Its silence would cost the reference that somebody has just given it.
TEST_F(ServoReturn, UntilItIsClearedItHearsZeroAndNoSilence) {
  lose();
  put_back();
  calibrate();
  ASSERT_EQ(rig.state(), OperatingState::Fault);
  rig.device.written.clear();
  rig.tick(5000);
  EXPECT_EQ(rig.device.written.size(), 5000U);
  expect_nothing_pushed();
}

TEST_F(ServoReturn, AClearBeforeItIsCalibratedIsRefusedAndDoesNotLieInWait) {
  lose();
  EXPECT_EQ(clear(), ClearOutcome::NotLatched);
  rig.device.next_status = IoStatus::NoData;
  rig.tick(5);
  ASSERT_EQ(rig.state(), OperatingState::Configured);
  EXPECT_EQ(clear(), ClearOutcome::NotLatched);
  put_back();
  ASSERT_EQ(rig.state(), OperatingState::Calibrating);
  EXPECT_EQ(clear(), ClearOutcome::NotLatched);
  calibrate();
  rig.tick(1000);
  EXPECT_EQ(rig.state(), OperatingState::Fault);
  expect_nothing_pushed();
  EXPECT_EQ(clear(), ClearOutcome::Cleared);
}

TEST_F(ServoReturn, ALoosePlugIsOneStopAndOneRecording) {
  lose();
  (void)rig.sut.recorder().take();
  for (int i = 0; i < 5; ++i) {
    put_back();
    if (i % 2 == 0) calibrate();
    EXPECT_EQ(rig.state(), i % 2 == 0 ? OperatingState::Fault : OperatingState::Calibrating);
    lose();
  }
  EXPECT_FALSE(rig.sut.recorder().is_frozen());
  EXPECT_EQ(rig.snapshot().faults, 1U);
}

// Active is driven, whatever the force is at that moment.
TEST(ServoReturns, OneThatIsActiveIsDrivenAlsoWhileItsForceIsNothing) {
  const std::vector<std::function<void(ServoRig&)>> ways{
      [](ServoRig& rig) {  // just activated
        rig.controls.want_active = true;
        while (rig.state() != OperatingState::Active) rig.tick();
      },
      [](ServoRig& rig) {  // let go of
        rig.activate_fully();
        rig.controls.is_deadman_held = false;
        rig.tick(100);
      },
      [](ServoRig& rig) {  // about to be released
        rig.activate_fully();
        rig.controls.want_active = false;
        rig.tick(5);
      }};
  for (const auto& way : ways) {
    ServoRig rig;
    way(rig);
    ASSERT_EQ(rig.state(), OperatingState::Active);
    rig.device.next_status = IoStatus::Disconnected;
    rig.tick();
    EXPECT_EQ(rig.snapshot().fault.number, 1U);
  }
}

TEST_F(ServoReturn, OneThatRestedOrWasNotCalibratedWhenItLeftNeedsNoClear) {
  rig.controls.want_active = false;
  rig.tick(1000);
  ASSERT_EQ(rig.state(), OperatingState::Inactive);
  for (const bool is_calibrated : {true, false}) {
    lose();
    EXPECT_EQ(rig.snapshot().fault.number, 0U);
    put_back();
    if (is_calibrated) calibrate();
    EXPECT_EQ(rig.snapshot().fault.code, FaultCode::None);
  }
  calibrate();
  EXPECT_EQ(rig.state(), OperatingState::Inactive);
  rig.controls.want_active = true;
  rig.tick(2);
  EXPECT_EQ(rig.state(), OperatingState::Active);
}

TEST(ServoReturns, OneWithoutMotorsNeedsNoClear) {
  ServoRig rig;
  rig.device.able.is_actuated = false;
  ServoLoop sut({rig.device, rig.coupling, rig.link, rig.controls, rig.clock, rig.clock},
                rig.settings_);
  ServoSnapshot seen;
  const auto run = [&] {
    for (int i = 0; i < 50; ++i) {
      rig.clock.advance(rig.settings_.period());
      sut.tick({});
    }
    ASSERT_TRUE(sut.snapshot(seen));
  };
  rig.controls.want_active = true;
  run();
  ASSERT_EQ(seen.frame.state, OperatingState::Active);
  rig.device.next_status = IoStatus::Disconnected;
  run();
  EXPECT_EQ(seen.fault.code, FaultCode::Disconnected);
  EXPECT_EQ(seen.fault.number, 0U);
  rig.device.next_status = IoStatus::Ok;
  run();
  EXPECT_EQ(seen.frame.state, OperatingState::Active);
}

TEST_F(ServoReturn, OneThatNobodyWantsAnyMoreIsInactiveOnceItIsCleared) {
  lose();
  rig.controls.want_active = false;
  put_back();
  calibrate();
  EXPECT_EQ(rig.state(), OperatingState::Fault) << "that it is wanted no more clears nothing";
  EXPECT_EQ(clear(), ClearOutcome::Cleared);
  rig.tick(1000);
  EXPECT_EQ(rig.state(), OperatingState::Inactive);
}

TEST_F(ServoReturn, OnceClearedThePlugMayBePulledAgainAndLatchesAgainWhenItIsDriven) {
  lose();
  put_back();
  calibrate();
  ASSERT_EQ(clear(), ClearOutcome::Cleared);
  ASSERT_EQ(rig.state(), OperatingState::Calibrating);
  lose();
  EXPECT_EQ(rig.snapshot().fault.number, 0U) << "it was not driven yet";
  put_back();
  calibrate();
  rig.tick(600);
  ASSERT_EQ(rig.state(), OperatingState::Active);
  lose();
  EXPECT_EQ(rig.snapshot().fault.number, 2U);
}

}  // namespace
}  // namespace thimble::servo
