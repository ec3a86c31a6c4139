// What a servo makes of commands that the arm, or its bus, does not take.
#include <gtest/gtest.h>

#include "tests/unit/servo/scripted_rig.hpp"

namespace thimble::servo {
namespace {

TEST(ServoCommands, AStuckWayOutIsNoFreshCommand) {
  DrivenRig rig;
  rig.device.write_status = IoStatus::Backlogged;
  rig.tick(20);
  EXPECT_EQ(rig.state(), OperatingState::Active);
  rig.tick();
  EXPECT_EQ(rig.snapshot().fault.code, FaultCode::CommandTimeout);
  EXPECT_EQ(rig.device.written.back(), Force3{});
}

TEST(ServoCommands, AStuckWayOutMissesExchangesThoughSamplesCome) {
  DrivenRig rig;
  EXPECT_EQ(rig.snapshot().missed_exchanges, 0U);
  rig.device.write_status = IoStatus::Backlogged;
  rig.tick(10);
  EXPECT_EQ(rig.snapshot().missed_exchanges, 8U) << "less that of the first and of the next";
}

TEST(ServoCommands, RepeatedBlocksOfTheWayOutLatchThoughEachIsShort) {
  DrivenRig rig;
  int rounds = 0;
  for (; rounds < 10 && rig.state() == OperatingState::Active; ++rounds) {
    rig.device.write_status = IoStatus::Backlogged;
    rig.tick(12);
    rig.device.write_status = IoStatus::Ok;
    rig.tick(3);
  }
  EXPECT_EQ(rounds, 3);
  EXPECT_EQ(rig.snapshot().fault.code, FaultCode::MissedExchanges);
  EXPECT_EQ(rig.device.written.back(), Force3{});
}

// It holds no force: nothing is to be taken away, and whoever activates it is not stopped for it.
TEST(ServoCommands, ZerosThatDoNotLeaveAreCountedAndStopNothing) {
  ServoRig rig;
  rig.tick(10);
  ASSERT_EQ(rig.state(), OperatingState::Inactive);
  rig.device.write_status = IoStatus::Backlogged;
  rig.tick(300);
  EXPECT_EQ(rig.state(), OperatingState::Inactive);
  EXPECT_EQ(rig.snapshot().missed_exchanges, 298U);
  rig.device.write_status = IoStatus::Ok;
  rig.activate_fully();
  EXPECT_EQ(rig.state(), OperatingState::Active);
}

// The servo ran, late by a little each time: the arm is to blame, and nothing is kept of what was
// late before a command that was taken.
TEST(ServoCommands, ACommandThatIsOverdueNamesTheArmUnlessTheServoWasAwayForMostOfTheTime) {
  for (const int away_ms : {1, 9, 12, 19}) {
    DrivenRig rig;
    rig.clock.advance(std::chrono::milliseconds(15));
    rig.tick();
    rig.device.write_status = IoStatus::Backlogged;
    rig.clock.advance(std::chrono::milliseconds(away_ms));
    rig.tick(20 - away_ms);
    ASSERT_EQ(rig.state(), OperatingState::Active) << away_ms;
    rig.tick();
    EXPECT_EQ(rig.snapshot().fault.code,
              away_ms > 10 ? FaultCode::ServoLate : FaultCode::CommandTimeout)
        << away_ms;
  }
}

// Not one: a driver whose every command is refused must not be shown as driven for ever.
TEST(ServoCommands, AnArmThatNeverTookACommandIsNotDriven) {
  ServoRig rig;
  rig.device.write_status = IoStatus::ProtocolError;
  rig.controls.want_active = true;
  rig.tick(60);
  EXPECT_EQ(rig.state(), OperatingState::Fault);
  EXPECT_EQ(rig.snapshot().fault.code, FaultCode::CommandTimeout);
}

}  // namespace
}  // namespace thimble::servo
