#include <gtest/gtest.h>

#include "tests/unit/servo/scripted_rig.hpp"

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

// As a Falcon whose firmware ran on while its cable was out: nobody has to be there.
struct ServoReturn : testing::Test {
  void pull_the_plug(int ticks = 5) {
    rig.device.next_status = IoStatus::Disconnected;
    rig.tick(ticks);
    rig.device.next_status = IoStatus::Ok;
    rig.device.written.clear();
  }
  void clear() {
    rig.controls.request_clear(rig.snapshot().fault.number);
    rig.tick();
  }
  DrivenRig rig;
};

TEST_F(ServoReturn, AnArmThatPushedAndComesBackCalibratedWaitsForAClear) {
  pull_the_plug();
  rig.tick(1000);
  EXPECT_EQ(rig.state(), OperatingState::Fault);
  EXPECT_EQ(rig.snapshot().fault.code, FaultCode::Disconnected);
  for (const Force3& force : rig.device.written) ASSERT_EQ(force, Force3{});

  clear();
  rig.tick(1000);
  EXPECT_EQ(rig.state(), OperatingState::Active);
  EXPECT_EQ(rig.device.written.back(), (Force3{4, 0, 0}));
}

TEST_F(ServoReturn, ALoosePlugIsOneStopAndOneRecording) {
  pull_the_plug();
  rig.tick(100);
  (void)rig.sut.recorder().take();
  for (int i = 0; i < 5; ++i) {
    pull_the_plug();
    rig.tick(100);
    EXPECT_EQ(rig.state(), OperatingState::Fault);
  }
  EXPECT_FALSE(rig.sut.recorder().is_frozen());
}

TEST_F(ServoReturn, WhoCalibratesItHasAskedForIt) {
  pull_the_plug();
  rig.device.state.calibration = CalibrationState::NeedsUser;
  rig.tick(static_cast<int>(0.06 * rig.settings_.rate_hz));
  rig.device.state.calibration = CalibrationState::Ok;
  rig.tick(1000);
  EXPECT_EQ(rig.state(), OperatingState::Active);
}

TEST_F(ServoReturn, AnArmThatRestedWhenItLeftNeedsNoClear) {
  rig.controls.want_active = false;
  rig.tick(1000);
  ASSERT_EQ(rig.state(), OperatingState::Inactive);
  pull_the_plug();
  rig.tick(100);
  EXPECT_EQ(rig.state(), OperatingState::Inactive);
}

}  // namespace
}  // namespace thimble::servo
