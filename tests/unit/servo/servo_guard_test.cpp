#include <gtest/gtest.h>

#include "tests/unit/servo/scripted_rig.hpp"

// What the servo tells its arm's guard, and what it makes of a guard that let the arm go.
namespace thimble::servo {
namespace {

MonotonicTime last_beat(const ServoRig& rig) {
  return MonotonicTime{Duration(rig.heartbeat.beat_at_ns.load())};
}

TEST(ServoGuard, SaysInEveryTickWhenItBeganWhateverTheState) {
  ServoRig rig;
  rig.controls.want_active = true;
  const auto expect_beats = [&](int ticks) {
    for (int i = 0; i < ticks; ++i) {
      rig.tick();
      ASSERT_EQ(last_beat(rig), rig.clock.now());
    }
  };
  expect_beats(600);
  EXPECT_EQ(rig.state(), OperatingState::Active);
  rig.press_estop();
  expect_beats(1000);
  rig.device.next_status = IoStatus::Disconnected;
  expect_beats(9);
}

TEST(ServoGuard, AnArmThatItsGuardLetGoIsNotDrivenUntilAPersonClearsIt) {
  DrivenRig rig;
  rig.heartbeat.interventions = 1;
  rig.tick();
  EXPECT_EQ(rig.snapshot().fault.code, FaultCode::ServoLate);
  EXPECT_EQ(rig.device.written.back(), Force3{});
  rig.tick(1000);
  EXPECT_EQ(rig.state(), OperatingState::Fault);

  rig.controls.request_clear(rig.snapshot().fault.number);
  rig.tick(2000);
  EXPECT_EQ(rig.state(), OperatingState::Active) << "one intervention stops it once";
  EXPECT_EQ(rig.device.written.back(), (Force3{4, 0, 0}));
}

// Driven again before the servo has said that the force was taken away, the arm would be told
// forces by its servo and zero by its guard, for as long as that lasts.
TEST(ServoGuard, AnArmThatItsGuardLetGoWhileItWasDeactivatedIsNotDrivenAgainBeforeAClear) {
  DrivenRig rig;
  rig.controls.want_active = false;
  for (int i = 0; i < 1000 && rig.state() != OperatingState::Inactive; ++i) rig.tick();
  ASSERT_EQ(rig.state(), OperatingState::Inactive);
  ASSERT_NE(rig.heartbeat.drive.load(), 0U);
  rig.heartbeat.interventions = 1;
  rig.controls.want_active = true;
  rig.tick();
  EXPECT_EQ(rig.snapshot().fault.code, FaultCode::ServoLate);
  rig.tick(1000);
  EXPECT_EQ(rig.state(), OperatingState::Fault);
  EXPECT_EQ(rig.snapshot().faults, 1U) << "one intervention stops it once";
  EXPECT_EQ(rig.heartbeat.drive.load(), 0U);
}

TEST(ServoGuard, WhatItDoesToAnArmThatIsStoppedAlreadyIsNoFurtherFault) {
  DrivenRig rig;
  rig.press_estop();
  rig.tick(5);
  ASSERT_NE(rig.heartbeat.drive.load(), 0U);
  rig.heartbeat.interventions = 1;
  rig.tick(1000);
  EXPECT_EQ(rig.snapshot().fault.code, FaultCode::Estop);
  EXPECT_EQ(rig.snapshot().faults, 1U);
}

TEST(ServoGuard, IsToldEachDriveByAnotherNumber) {
  DrivenRig rig;
  EXPECT_EQ(rig.heartbeat.drive.load(), 1U);
  for (std::uint32_t drive = 2; drive < 5; ++drive) {
    rig.controls.want_active = false;
    rig.tick(1000);
    EXPECT_EQ(rig.heartbeat.drive.load(), 0U);
    rig.controls.want_active = true;
    rig.tick(1000);
    EXPECT_EQ(rig.heartbeat.drive.load(), drive);
  }
}

TEST(ServoGuard, IsToldOfADrivenArmBeforeItsFirstForceAndUntilZeroWasTakenForTwentyMilliseconds) {
  ServoRig rig;
  rig.device.on_write = [&] {
    const bool is_force = norm(rig.device.written.back()) > 0;
    if (is_force) {
      EXPECT_EQ(rig.heartbeat.drive.load(), 1U);
    }
  };
  rig.device.state.calibration = CalibrationState::NeedsUser;
  rig.tick(100);
  EXPECT_EQ(rig.heartbeat.drive.load(), 0U) << "its firmware may be on its way";
  rig.device.state.calibration = CalibrationState::Ok;
  rig.coupling.wish = {4, 0, 0};
  rig.activate_fully();
  EXPECT_EQ(rig.heartbeat.drive.load(), 1U);

  rig.press_estop();
  rig.tick(19);
  EXPECT_EQ(rig.heartbeat.drive.load(), 1U);
  rig.tick(1);
  EXPECT_EQ(rig.heartbeat.drive.load(), 0U);
}

TEST(ServoGuard, IsToldOfAnArmThatTakesNoZeroAsLongAsItDoesNot) {
  DrivenRig rig;
  rig.device.write_status = IoStatus::Backlogged;
  rig.press_estop();
  rig.tick(1000);
  EXPECT_EQ(rig.heartbeat.drive.load(), 1U);
  rig.device.write_status = IoStatus::Ok;
  rig.tick(21);
  EXPECT_EQ(rig.heartbeat.drive.load(), 0U);
}

// The last write that ended may have been of a force; what hangs behind it, too.
TEST(ServoGuard, IsToldOfAnArmWhoseWayOutHangsRightAfterTheStop) {
  for (const std::size_t ends : {1U, 2U}) {
    DrivenRig rig;
    const std::size_t before = rig.device.written.size();
    rig.device.on_write = [&] {
      const bool has_hung_up = rig.device.written.size() > before + ends;
      rig.device.write_status = has_hung_up ? IoStatus::Backlogged : IoStatus::Ok;
    };
    rig.press_estop();
    rig.tick(1000);
    EXPECT_EQ(rig.heartbeat.drive.load(), 1U) << ends;
  }
}

TEST(ServoGuard, IsNotPutOffByABusThatIsBusyNowAndThen) {
  DrivenRig rig;
  rig.device.on_write = [&] {
    const bool is_busy = rig.device.written.size() % 4 != 0;
    rig.device.write_status = is_busy ? IoStatus::Backlogged : IoStatus::Ok;
  };
  rig.press_estop();
  rig.tick(30);
  EXPECT_EQ(rig.heartbeat.drive.load(), 0U);
  rig.tick(200);
  const std::size_t written = rig.device.written.size();
  rig.tick(100);
  EXPECT_EQ(rig.device.written.size(), written) << "silent, and its watchdog takes the power away";
}

// It may never have heard one.
TEST(ServoGuard, AnArmThatTakesNoZeroIsNotLeftInSilence) {
  DrivenRig rig;
  rig.device.write_status = IoStatus::Backlogged;
  rig.press_estop();
  rig.tick(1000);
  const std::size_t written = rig.device.written.size();
  rig.tick(100);
  EXPECT_EQ(rig.device.written.size(), written + 100);
}

// The guard's own way to the arm may be free.
TEST(ServoGuard, SeesNoBeatOfAServoWhoseCommandsDoNotLeave) {
  DrivenRig rig;
  rig.device.write_status = IoStatus::Backlogged;
  rig.tick(20);
  const MonotonicTime last = last_beat(rig);
  rig.tick(100);
  EXPECT_EQ(last_beat(rig), last);
  rig.device.write_status = IoStatus::Ok;
  rig.tick(10);
  EXPECT_EQ(last_beat(rig), rig.clock.now());
}

TEST(ServoGuard, OfAnArmThatIsNotDrivenItIsNoFault) {
  ServoRig rig;
  rig.device.state.calibration = CalibrationState::NeedsUser;
  rig.tick(100);
  rig.heartbeat.interventions = 3;
  rig.tick();
  EXPECT_EQ(rig.snapshot().fault.code, FaultCode::None);
}

TEST(ServoGuard, AnArmThatIsGoneOrWasClearedIsDrivenNoMore) {
  DrivenRig gone;
  gone.device.next_status = IoStatus::Disconnected;
  gone.tick();
  EXPECT_EQ(gone.heartbeat.drive.load(), 0U);

  DrivenRig cleared;
  cleared.press_estop();
  cleared.controls.want_active = false;
  cleared.controls.request_clear(cleared.snapshot().fault.number);
  cleared.tick();
  EXPECT_EQ(cleared.heartbeat.drive.load(), 0U);
}

TEST(ServoGuard, NumbersOfNobodyStopAnArmAndDoNoMore) {
  DrivenRig rig;
  rig.heartbeat.interventions = 0xffffffffU;
  rig.heartbeat.drive = 17;
  rig.tick();
  EXPECT_EQ(rig.snapshot().fault.code, FaultCode::ServoLate);
  rig.tick(30);
  EXPECT_EQ(rig.heartbeat.drive.load(), 0U);
}

TEST(ServoGuard, AnArmWhoseGuardEndsIsStoppedAndNotDrivenBeforeItHasAnother) {
  DrivenRig rig;
  rig.controls.is_guarded = false;
  rig.tick();
  EXPECT_EQ(rig.snapshot().fault.code, FaultCode::GuardLost);
  EXPECT_EQ(rig.device.written.back(), Force3{});
  rig.controls.request_clear(rig.snapshot().fault.number);
  rig.tick(1000);
  EXPECT_EQ(rig.state(), OperatingState::Inactive);
  rig.controls.is_guarded = true;
  rig.tick(1000);
  EXPECT_EQ(rig.state(), OperatingState::Active);
}

TEST(ServoGuard, AnArmThatIsNotDrivenHasNothingToFearFromAGuardThatEnds) {
  ServoRig rig;
  rig.tick(100);
  rig.controls.is_guarded = false;
  rig.tick(100);
  EXPECT_EQ(rig.snapshot().fault.code, FaultCode::None);
}

TEST(ServoGuard, AnArmWithoutOneIsDrivenAllTheSame) {
  DrivenRig rig;
  ServoLoop alone{
      ServoParts{rig.device, rig.coupling, rig.link, rig.controls, rig.clock, rig.clock},
      rig.settings_};
  for (int i = 0; i < 700; ++i) {
    rig.clock.advance(rig.settings_.period());
    alone.tick(Duration{});
  }
  EXPECT_EQ(rig.device.written.back(), (Force3{4, 0, 0}));
}

}  // namespace
}  // namespace thimble::servo
