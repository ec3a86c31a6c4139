#include <gtest/gtest.h>

#include "tests/unit/servo/scripted_rig.hpp"

// What the servo tells its arm's guard, and what it makes of a guard that let the arm go.
namespace thimble::servo {
namespace {

TEST(ServoGuard, BeatsOnceInEveryTickWhateverTheState) {
  ServoRig rig;
  rig.activate_fully();
  EXPECT_EQ(rig.heartbeat.beats.load(), 600U);
  rig.press_estop();
  rig.tick(1000);
  rig.device.next_status = IoStatus::Disconnected;
  rig.tick(9);
  EXPECT_EQ(rig.heartbeat.beats.load(), 1610U);
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

TEST(ServoGuard, IsAnsweredInTheTickInWhichTheArmTookZero) {
  DrivenRig rig;
  rig.device.write_status = IoStatus::Backlogged;
  rig.heartbeat.interventions = 1;
  rig.tick();
  EXPECT_EQ(rig.heartbeat.acknowledged.load(), 0U) << "the zero has not left";
  rig.device.write_status = IoStatus::Ok;
  rig.tick();
  EXPECT_EQ(rig.device.written.back(), Force3{});
  EXPECT_EQ(rig.heartbeat.acknowledged.load(), 1U);
}

TEST(ServoGuard, OfAnArmThatIsNotDrivenIsAnsweredAndIsNoFault) {
  ServoRig rig;
  rig.device.state.calibration = CalibrationState::NeedsUser;
  rig.tick(100);
  rig.heartbeat.interventions = 3;
  rig.tick();
  EXPECT_EQ(rig.heartbeat.acknowledged.load(), 3U);
  EXPECT_EQ(rig.snapshot().fault.code, FaultCode::None);
}

TEST(ServoGuard, OfAnArmThatIsSilentAfterAStopOrGoneIsAnswered) {
  DrivenRig rig;
  rig.press_estop();
  rig.tick(200);
  rig.heartbeat.interventions = 1;
  rig.tick();
  EXPECT_EQ(rig.heartbeat.acknowledged.load(), 1U);
  EXPECT_EQ(rig.snapshot().fault.code, FaultCode::Estop) << "the first stays";

  rig.device.next_status = IoStatus::Disconnected;
  rig.heartbeat.interventions = 2;
  rig.tick();
  EXPECT_EQ(rig.heartbeat.acknowledged.load(), 2U);
}

TEST(ServoGuard, NumbersOfNobodyStopAnArmAndDoNoMore) {
  DrivenRig rig;
  rig.heartbeat.interventions = 0xffffffffU;
  rig.heartbeat.acknowledged = 17;
  rig.tick();
  EXPECT_EQ(rig.snapshot().fault.code, FaultCode::ServoLate);
  rig.heartbeat.interventions = 0;
  rig.tick(3);
  EXPECT_EQ(rig.heartbeat.acknowledged.load(), 0U);
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
