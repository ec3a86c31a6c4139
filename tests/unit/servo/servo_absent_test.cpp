#include <gtest/gtest.h>

#include "daemon/servo/servo_loop.hpp"
#include "tests/unit/servo/scripted_rig.hpp"

namespace thimble::servo {
namespace {

TEST(ServoAbsent, AnArmThatWasNeverThereIsLostFromTheStartAndThatIsNoStop) {
  ServoRig rig;
  ServoLoop sut({rig.device, rig.coupling, rig.link, rig.controls, rig.clock, rig.clock,
                 &rig.heartbeat, true},
                rig.settings_);
  rig.controls.want_active = true;
  rig.device.next_status = IoStatus::Disconnected;
  ServoSnapshot seen;
  ASSERT_TRUE(sut.snapshot(seen));
  EXPECT_EQ(seen.frame.state, OperatingState::Lost) << "before the first tick, too";
  for (int i = 0; i < 50; ++i) {
    rig.clock.advance(rig.settings_.period());
    sut.tick({});
  }
  ASSERT_TRUE(sut.snapshot(seen));
  EXPECT_EQ(seen.frame.state, OperatingState::Lost);
  EXPECT_EQ(seen.fault.code, FaultCode::None);
  EXPECT_FALSE(sut.recorder().is_frozen()) << "there is nothing to look at";
  EXPECT_TRUE(rig.device.written.empty());
  EXPECT_EQ(rig.heartbeat.drive.load(), 0U);

  rig.device.next_status = IoStatus::Ok;
  rig.device.state.calibration = CalibrationState::NeedsUser;
  rig.clock.advance(rig.settings_.period());
  sut.tick({});
  ASSERT_TRUE(sut.snapshot(seen));
  EXPECT_EQ(seen.frame.state, OperatingState::Calibrating) << "and comes as one that returns";
}

}  // namespace
}  // namespace thimble::servo
