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

}  // namespace
}  // namespace thimble::servo
