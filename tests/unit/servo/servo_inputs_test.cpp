#include <gtest/gtest.h>

#include "tests/unit/servo/scripted_rig.hpp"

// What comes in where nobody hoped for it: a clock that stands, reports that are none, safety
// inputs and calibration that change at the wrong moment.
namespace thimble::servo {
namespace {

TEST(ServoInputs, AClockThatStandsStillIsTakenForOnePeriod) {
  ServoRig rig;
  rig.coupling.wish = {4, 0, 0};
  rig.controls.want_active = true;
  rig.tick(10);
  ASSERT_EQ(rig.state(), OperatingState::Active);
  const double before = rig.device.written.back().x;

  for (int i = 0; i < 100; ++i) rig.sut.tick(Duration{});

  EXPECT_EQ(rig.coupling.last.dt, rig.settings_.period());
  EXPECT_NEAR(rig.device.written.back().x - before, 100 * 4.0 / 500, 1e-9) << "the ramp goes on";
}

TEST(ServoInputs, AReportThatIsNoneIsCountedAndIsNoSample) {
  ServoRig rig;
  rig.activate_fully();
  rig.link.sent.clear();
  rig.device.state.tip = {0.5, 0, 0};
  rig.device.next_status = IoStatus::ProtocolError;

  rig.tick(2);

  EXPECT_EQ(rig.snapshot().protocol_errors, 2U);
  EXPECT_EQ(rig.snapshot().frame.tip, Position3{});
  EXPECT_TRUE(rig.link.sent.empty());
  EXPECT_EQ(rig.state(), OperatingState::Active);
}

TEST(ServoInputs, AnEstopWhileTheArmIsAwayIsLatchedWhenItIsBackUnlessTheUnplugIs) {
  for (const bool is_driven : {false, true}) {
    ServoRig rig;
    rig.coupling.wish = {4, 0, 0};
    rig.controls.want_active = is_driven;
    rig.tick(600);
    rig.device.next_status = IoStatus::Disconnected;
    rig.tick();
    rig.controls.is_estop_healthy = false;
    rig.tick(5);
    EXPECT_EQ(rig.state(), OperatingState::Lost);
    EXPECT_EQ(rig.snapshot().fault.code, FaultCode::Disconnected);

    rig.device.next_status = IoStatus::Ok;
    rig.device.written.clear();
    rig.tick(50);

    EXPECT_EQ(rig.state(), OperatingState::Fault);
    EXPECT_EQ(rig.snapshot().fault.code, is_driven ? FaultCode::Disconnected : FaultCode::Estop);
    rig.controls.request_clear(rig.snapshot().fault.number);
    rig.tick(50);
    EXPECT_EQ(rig.state(), OperatingState::Fault) << "it is still pressed";
    for (const Force3& force : rig.device.written) ASSERT_EQ(force, Force3{});
  }
}

TEST(ServoInputs, AnEstopBeforeTheArmWasEverDrivenIsLatchedAndFreezesNothing) {
  ServoRig rig;
  rig.controls.is_estop_healthy = false;
  rig.tick(3);
  EXPECT_EQ(rig.snapshot().fault.code, FaultCode::Estop);
  EXPECT_EQ(rig.state(), OperatingState::Fault);
  EXPECT_FALSE(rig.sut.recorder().is_frozen());

  rig.controls.is_estop_healthy = true;
  rig.controls.request_clear(rig.snapshot().fault.number);
  rig.tick();
  rig.activate_fully();
  rig.press_estop();
  EXPECT_TRUE(rig.sut.recorder().is_frozen()) << "this one stopped an arm";
}

TEST(ServoInputs, AnArmThatHasSaidNothingYetIsWaitedFor) {
  ServoRig rig;
  rig.controls.want_active = true;
  rig.device.next_status = IoStatus::NoData;
  rig.tick(1000);
  EXPECT_EQ(rig.state(), OperatingState::Configured);
  EXPECT_EQ(rig.snapshot().faults, 0U);

  rig.device.next_status = IoStatus::Ok;
  rig.tick(10);
  EXPECT_EQ(rig.state(), OperatingState::Active);
}

TEST(ServoInputs, LosingTheReferenceAtRestIsNoFaultAndMeansCalibratingAgain) {
  ServoRig rig;
  rig.tick(10);
  ASSERT_EQ(rig.state(), OperatingState::Inactive);
  rig.device.state.calibration = CalibrationState::NeedsUser;
  rig.controls.want_active = true;

  rig.tick();

  EXPECT_EQ(rig.state(), OperatingState::Calibrating);
  EXPECT_EQ(rig.snapshot().faults, 0U);
  rig.device.state.calibration = CalibrationState::Ok;
  rig.tick(10);
  EXPECT_EQ(rig.state(), OperatingState::Active);
}

TEST(ServoInputs, AnArmWhoseSampleIsOldIsNotActivated) {
  ServoRig rig;
  rig.tick(10);
  rig.device.next_status = IoStatus::NoData;
  rig.tick(5);
  ASSERT_TRUE(rig.snapshot().frame.is_stale);
  rig.controls.want_active = true;

  rig.tick(5);

  EXPECT_EQ(rig.state(), OperatingState::Inactive);
  rig.device.next_status = IoStatus::Ok;
  rig.tick(5);
  EXPECT_EQ(rig.state(), OperatingState::Active);
}

TEST(ServoInputs, TheGhostRestartsAtTheHandWhenTheDeadmanIsHeldAgain) {
  ServoRig rig;
  rig.coupling.wish = {4, 0, 0};
  rig.activate_fully();
  rig.controls.is_deadman_held = false;
  rig.tick(100);
  for (int i = 1; i <= 100; ++i) {
    rig.device.state.tip.y = i * 0.0001;  // 0.1 m/s
    rig.tick();
  }
  ASSERT_EQ(rig.coupling.resets, 1) << "not yet: the hand goes on moving";

  rig.controls.is_deadman_held = true;
  rig.tick();

  EXPECT_EQ(rig.coupling.resets, 2);
  EXPECT_EQ(rig.coupling.reset_tip, (Position3{0, 0.01, 0}));
  EXPECT_LT(rig.device.written.back().x, 0.1) << "ramped from zero";
  rig.tick(600);
  EXPECT_EQ(rig.coupling.resets, 2);
  EXPECT_EQ(rig.device.written.back().x, 4);
}

TEST(ServoInputs, SaysWhichTicksGaveLessThanTheWorldWanted) {
  ServoRig rig;
  rig.coupling.wish = {4, 0, 0};
  rig.activate_fully();
  EXPECT_FALSE(rig.snapshot().frame.is_limited);

  rig.coupling.wish = {0, 4, 0};
  rig.tick();
  EXPECT_TRUE(rig.snapshot().frame.is_limited) << "rises too fast";
  rig.tick(20);
  EXPECT_FALSE(rig.snapshot().frame.is_limited);

  rig.coupling.wish = {0, 20, 0};
  rig.tick(100);
  EXPECT_TRUE(rig.snapshot().frame.is_limited) << "more than the arm's 8 N";
  EXPECT_NEAR(norm(rig.device.written.back()), 8, 1e-9);

  rig.coupling.wish = {0, 4, 0};
  for (std::size_t i = 0; i < 3; ++i) rig.device.state.motor_current_per_force.row[i][i] = 1;
  rig.tick(20);
  EXPECT_TRUE(rig.snapshot().frame.is_limited) << "more than the motors' 3 A";
  EXPECT_NEAR(norm(rig.device.written.back()), 3, 1e-9);
}

}  // namespace
}  // namespace thimble::servo
