// What a person is told of an arm that stands still, where the next step is not the obvious one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <optional>
#include <string>

#include "daemon/app/arm_commands.hpp"
#include "daemon/session/arm_instruction.hpp"
#include "tests/scenario/safety_lab.hpp"
#include "tests/support/closed_loop.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string instruction(test::ClosedLoop& loop) { return session::instruction_for(loop.arm()); }

// Driven, then stopped by a tick that came too late.
void drive_and_stop(test::ClosedLoop& loop) {
  ASSERT_TRUE(loop.run_until(8, [&] { return loop.frame().state == OperatingState::Active; }));
  loop.run(0.1);
  loop.tick(milliseconds(30));
  ASSERT_EQ(loop.frame().state, OperatingState::Fault);
}

TEST(ToldInTrouble, AnArmThatWasSilentForTooLongIsToBeCalibratedOnceItIsCleared) {
  for (const std::string device : {"sim:phantom-vintage", "sim:woody-2015-serial"}) {
    SCOPED_TRACE(device);
    test::ClosedLoop sut({"arm.0.device=" + device, "arm.hand.motion=still"});
    drive_and_stop(sut);
    EXPECT_THAT(instruction(sut), Not(HasSubstr("calibrate")));
    sut.run(1);
    EXPECT_THAT(instruction(sut), HasSubstr("thimble clear-fault right, and calibrate it"));
    sut.controls().request_clear(sut.snapshot().fault.number);
    sut.run(0.05);
    EXPECT_EQ(sut.frame().state, OperatingState::Calibrating) << "as it was told";
  }
}

TEST(ToldInTrouble, OneThatKeepsItsPlaceIsOnlyToBeCleared) {
  test::ClosedLoop sut({"arm.0.device=sim:falcon-loaded", "arm.hand.motion=still"});
  drive_and_stop(sut);
  sut.run(1);
  EXPECT_THAT(instruction(sut), AllOf(HasSubstr("clear-fault"), Not(HasSubstr("calibrate"))));
  sut.controls().request_clear(sut.snapshot().fault.number);
  sut.run(0.05);
  EXPECT_NE(sut.frame().state, OperatingState::Calibrating);
}

std::string refusal(test::ClosedLoop& loop, app::ArmCommands& commands) {
  std::optional<Result<api::Done>> told;
  commands.activate("right", test::kPerson, [&](const Result<api::Done>& done) { told = done; });
  loop.run_until(5, [&] {
    commands.poll();
    return told.has_value();
  });
  return told && !*told ? told->error().message : "no refusal";
}

TEST(ToldInTrouble, WhoActivatesAFalconWithoutFirmwareHearsOfTheFirmware) {
  test::ClosedLoop loop({"arm.0.device=sim:falcon", "arm.activate=false"});
  app::Leases leases{{{"right", false}}};
  app::ArmCommands sut{loop.runtime(), leases, loop.arm().clock()};
  loop.run(3);
  EXPECT_THAT(refusal(loop, sut), AllOf(HasSubstr("firmware"), Not(HasSubstr("cable"))));
}

TEST(ToldInTrouble, WhoActivatesBeforeTheFirstClearIsNotToldOfAPressedButton) {
  test::SafetyLab sut({"arm.activate=false"});
  sut.run(0.5);
  EXPECT_THAT(refusal(sut.loop, sut.commands),
              AllOf(HasSubstr("not yet cleared since the start"), Not(HasSubstr("pressed"))));
  sut.press(true);
  sut.run(0.1);
  EXPECT_THAT(refusal(sut.loop, sut.commands), HasSubstr("pressed"));
}

}  // namespace
}  // namespace thimble
