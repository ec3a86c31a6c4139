#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

#include "daemon/app/arm_commands.hpp"
#include "tests/support/closed_loop.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

constexpr api::ClientId kHer{7};
constexpr api::ClientId kHim{8};

// An arm that nobody drives until a client asks, in virtual time.
class Commands : public testing::Test {
 protected:
  using Told = std::optional<Result<api::Done>>;

  static api::Answer keep(Told& told) {
    return [&told](const Result<api::Done>& done) {
      EXPECT_FALSE(told.has_value()) << "answered twice";
      told = done;
    };
  }
  void poll_for(double s) {
    loop_.run(s, [this] { sut_.poll(); });
  }
  // The answer, which must come within `s`.
  Result<api::Done> answer_in(const Told& told, double s = 2.1) {
    loop_.run_until(s, [&] {
      sut_.poll();
      return told.has_value();
    });
    return told.value_or(fail(Errc::System, "no answer at all"));
  }
  Result<api::Done> activate(api::ClientId client = kHer) {
    Told told;
    sut_.activate("right", client, keep(told));
    return answer_in(told);
  }
  Result<api::Done> clear(std::optional<std::uint32_t> fault = {}) {
    Told told;
    sut_.clear_fault("right", fault, kHer, keep(told));
    return answer_in(told);
  }
  void stop() {
    loop_.controls().is_estop_healthy = false;
    loop_.tick();
    ASSERT_EQ(loop_.frame().state, OperatingState::Fault);
  }
  // The plug of an arm that leans on a wall is out, as her lease is still hers.
  void lose_while_driven() {
    calibrate();
    ASSERT_TRUE(activate(kHer));
    loop_.run_until_leaning();
    loop_.sim_arm().backend().push_tip({});
    loop_.unplug();
    loop_.tick();
    ASSERT_EQ(state(), OperatingState::Lost);
  }
  void run_until(OperatingState wanted) {
    ASSERT_TRUE(loop_.run_until(5, [&] { return state() == wanted; })) << to_string(state());
  }
  void calibrate() {
    ASSERT_TRUE(loop_.run_until(2, [&] { return state() == OperatingState::Inactive; }));
  }
  OperatingState state() { return loop_.frame().state; }

  test::ClosedLoop loop_{{"arm.hand.motion=still", "arm.activate=false"}};
  app::Leases leases_{{{"right", false}}};
  app::ArmCommands sut_{loop_.runtime(), leases_, loop_.arm().clock()};
};

TEST_F(Commands, AnActivationIsAnsweredWhenTheArmIsActive) {
  calibrate();
  Told told;
  sut_.activate("right", kHer, keep(told));
  sut_.poll();
  EXPECT_FALSE(told.has_value()) << "no tick has seen it yet";
  const Result<api::Done> done = answer_in(told, 0.01);
  ASSERT_TRUE(done) << done.error().message;
  EXPECT_EQ(done->state, "active");
  EXPECT_EQ(done->instruction, "");
  EXPECT_EQ(state(), OperatingState::Active);
}

TEST_F(Commands, AnArmThatWaitsForAPersonSaysSoAndIsActiveOnceCalibrated) {
  loop_.run(0.1);
  const Result<api::Done> done = activate();
  ASSERT_TRUE(done) << done.error().message;
  EXPECT_EQ(done->state, "calibrating");
  EXPECT_THAT(done->instruction, HasSubstr("press the calibration button"));
  EXPECT_EQ(leases_.holder(0), app::Leases::Holder::Client);
  EXPECT_TRUE(loop_.run_until(2, [&] { return state() == OperatingState::Active; }));
}

TEST_F(Commands, AnArmInAFaultIsNotActivatedAndTheCauseIsNamed) {
  calibrate();
  stop();
  const Result<api::Done> done = activate();
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, Errc::Busy);
  EXPECT_THAT(done.error().message, AllOf(HasSubstr("estop"), HasSubstr("clear")));
  EXPECT_EQ(leases_.holder(0), app::Leases::Holder::Nobody);
  EXPECT_FALSE(loop_.controls().want_active);
}

TEST_F(Commands, ALostArmIsNotActivated) {
  calibrate();
  loop_.unplug();
  loop_.tick();
  const Result<api::Done> done = activate();
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, Errc::Disconnected);
  EXPECT_THAT(done.error().message, HasSubstr("plug it in"));
  EXPECT_EQ(leases_.holder(0), app::Leases::Holder::Nobody);
  EXPECT_FALSE(clear());
}

TEST_F(Commands, AFaultThatComesBetweenAskingAndDrivingIsTheAnswerAndTakesTheLeaseBack) {
  calibrate();
  Told told;
  sut_.activate("right", kHer, keep(told));
  stop();
  const Result<api::Done> done = answer_in(told);
  ASSERT_FALSE(done);
  EXPECT_THAT(done.error().message, HasSubstr("estop"));
  EXPECT_EQ(leases_.holder(0), app::Leases::Holder::Nobody);
  EXPECT_FALSE(loop_.controls().want_active);
}

TEST_F(Commands, AServoThatDoesNotRunIsToldInTimeAndNothingIsLeftToHappenLater) {
  calibrate();
  Told told;
  sut_.activate("right", kHer, keep(told));
  static_cast<void>(loop_.arm().clock().sleep_until(loop_.now() + app::ArmCommands::kPatience));
  sut_.poll();
  ASSERT_TRUE(told.has_value());
  EXPECT_EQ(told->error().code, Errc::Timeout);
  EXPECT_FALSE(loop_.controls().want_active);

  stop();
  loop_.controls().is_estop_healthy = true;
  told.reset();
  sut_.clear_fault("right", {}, kHer, keep(told));
  static_cast<void>(loop_.arm().clock().sleep_until(loop_.now() + app::ArmCommands::kPatience));
  sut_.poll();
  ASSERT_TRUE(told.has_value());
  EXPECT_EQ(told->error().code, Errc::Timeout);
  loop_.run(0.1);
  EXPECT_EQ(state(), OperatingState::Fault) << "a refused request must not come true";
}

TEST_F(Commands, ASecondClientIsRefusedAndTheFirstKeepsTheArm) {
  calibrate();
  ASSERT_TRUE(activate(kHer));
  EXPECT_EQ(activate(kHim).error().code, Errc::Busy);
  EXPECT_EQ(state(), OperatingState::Active);
}

TEST_F(Commands, AnArmTakenOverWhileAskingIsNotTheFirstClients) {
  calibrate();
  Told hers, his, released;
  sut_.activate("right", kHer, keep(hers));
  sut_.deactivate("right", kHim, keep(released));
  sut_.activate("right", kHim, keep(his));
  poll_for(0.1);
  EXPECT_FALSE(hers.value());
  EXPECT_TRUE(his.value());
  EXPECT_TRUE(leases_.is_held_for(0, kHim.value));
}

TEST_F(Commands, AClientThatIsGoneHearsNothingAndHoldsNothing) {
  calibrate();
  Told told;
  sut_.activate("right", kHer, keep(told));
  sut_.client_gone(kHer);
  poll_for(2.2);
  EXPECT_FALSE(told.has_value());
  EXPECT_EQ(state(), OperatingState::Inactive);
}

TEST_F(Commands, AClearedFaultIsAnsweredWhenTheServoHasLeftIt) {
  calibrate();
  stop();
  loop_.controls().is_estop_healthy = true;
  Told told;
  sut_.clear_fault("right", {}, kHer, keep(told));
  sut_.poll();
  EXPECT_FALSE(told.has_value());
  const Result<api::Done> done = answer_in(told, 0.01);
  ASSERT_TRUE(done) << done.error().message;
  EXPECT_NE(done->state, "fault");
  EXPECT_NE(state(), OperatingState::Fault);
}

// docs/decisions/0236.
TEST_F(Commands, AClearedFaultSetsALeasedArmMovingAgainWhoeverClearsIt) {
  calibrate();
  ASSERT_TRUE(activate(kHim));
  loop_.run_until_driven();
  stop();
  loop_.controls().is_estop_healthy = true;
  poll_for(1);
  EXPECT_EQ(state(), OperatingState::Fault);
  ASSERT_TRUE(clear()) << "hers is no lease";
  ASSERT_TRUE(loop_.run_until(2, [&] { return state() == OperatingState::Active; }));
  EXPECT_LT(loop_.frame().gain, 0.01) << "its force begins at zero";
}

TEST_F(Commands, APressedStopKeepsTheFaultAndIsNamed) {
  calibrate();
  stop();
  const Result<api::Done> done = clear();
  ASSERT_FALSE(done);
  EXPECT_THAT(done.error().message, HasSubstr("emergency stop is pressed"));
  loop_.controls().is_estop_healthy = true;
  loop_.run(0.1);
  EXPECT_EQ(state(), OperatingState::Fault) << "the request is spent";
  EXPECT_TRUE(clear());
}

TEST_F(Commands, AFaultThatComesAtOnceAgainIsTheAnswer) {
  calibrate();
  stop();
  loop_.controls().is_estop_healthy = true;
  Told told;
  sut_.clear_fault("right", {}, kHer, keep(told));
  loop_.tick();
  stop();
  const Result<api::Done> done = answer_in(told);
  ASSERT_FALSE(done);
  EXPECT_THAT(done.error().message, HasSubstr("stopped again"));
}

TEST_F(Commands, TwoWhoClearTheSameFaultAreBothAnswered) {
  calibrate();
  stop();
  loop_.controls().is_estop_healthy = true;
  Told hers, his, late;
  sut_.clear_fault("right", {}, kHer, keep(hers));
  sut_.clear_fault("right", {}, kHim, keep(his));
  poll_for(0.01);
  EXPECT_TRUE(hers.value());
  EXPECT_TRUE(his.value());
  EXPECT_THAT(clear().error().message, HasSubstr("no latched fault"));
}

TEST_F(Commands, WhoeverGoesLeavesTheOthersTheirWishToClearTheSameFault) {
  for (const api::ClientId gone : {kHer, kHim}) {
    if (state() != OperatingState::Inactive) calibrate();
    stop();
    loop_.controls().is_estop_healthy = true;
    Told hers, his;
    sut_.clear_fault("right", {}, kHer, keep(hers));
    sut_.clear_fault("right", {}, kHim, keep(his));
    sut_.client_gone(gone);
    const Told& left = gone == kHer ? his : hers;
    const Result<api::Done> done = answer_in(left, 0.01);
    EXPECT_TRUE(done) << done.error().message;
  }
}

TEST_F(Commands, WhenAllWhoAskedHaveGoneTheFaultStays) {
  calibrate();
  stop();
  loop_.controls().is_estop_healthy = true;
  Told hers, his;
  sut_.clear_fault("right", {}, kHer, keep(hers));
  sut_.clear_fault("right", {}, kHim, keep(his));
  sut_.client_gone(kHim);
  sut_.client_gone(kHer);
  loop_.run(0.1);
  EXPECT_EQ(state(), OperatingState::Fault) << "nobody is left to be told";
}

TEST_F(Commands, AnArmThatIsLostMeanwhileKeepsItsFaultAndSaysSo) {
  calibrate();
  stop();
  loop_.controls().is_estop_healthy = true;
  loop_.unplug();
  Told told;
  sut_.clear_fault("right", {}, kHer, keep(told));
  loop_.controls().is_estop_healthy = false;  // so that it is not cleared just before
  const Result<api::Done> done = answer_in(told);
  ASSERT_FALSE(done) << "told as cleared: " << done->state;
  EXPECT_EQ(done.error().code, Errc::Disconnected);
  EXPECT_THAT(done.error().message, HasSubstr("can be cleared when it is back"));
}

TEST_F(Commands, AnArmThatWasPulledWhileItWasDrivenIsCalibratedThenClearedAndThenGoesOn) {
  lose_while_driven();
  EXPECT_EQ(clear().error().code, Errc::Disconnected);
  loop_.replug();
  for (const OperatingState early : {OperatingState::Configured, OperatingState::Calibrating}) {
    run_until(early);
    EXPECT_EQ(clear().error().code, Errc::Busy);
    EXPECT_THAT(clear().error().message, AllOf(HasSubstr("not calibrated yet"),
                                               HasSubstr("calibrate it; if it was driven, clear")));
    const Result<api::Done> refused = activate(kHer);
    ASSERT_FALSE(refused) << "it would not become active by being calibrated";
    EXPECT_THAT(refused.error().message, HasSubstr("disconnected"));
  }
  run_until(OperatingState::Fault);
  loop_.run(3);
  EXPECT_EQ(state(), OperatingState::Fault);
  const Result<api::Done> done = clear(1);
  ASSERT_TRUE(done) << done.error().message;
  run_until(OperatingState::Active);
  EXPECT_TRUE(leases_.is_held_for(0, kHer.value)) << "as before";
}

TEST_F(Commands, AnArmThatIsPulledWhileItIsClearedIsToldAsItIs) {
  lose_while_driven();
  loop_.replug();
  run_until(OperatingState::Fault);
  loop_.unplug();
  Told told;
  sut_.clear_fault("right", {}, kHer, keep(told));
  loop_.controls().is_estop_healthy = false;  // so that it is not cleared just before
  loop_.tick();
  loop_.controls().is_estop_healthy = true;
  ASSERT_EQ(state(), OperatingState::Lost);
  EXPECT_EQ(answer_in(told).error().code, Errc::Disconnected);
  loop_.replug();
  run_until(OperatingState::Fault);
  EXPECT_TRUE(clear());
}

TEST_F(Commands, NoPressedStopIsBlamedForAWishThatWasTakenBack) {
  calibrate();
  stop();
  loop_.controls().is_estop_healthy = true;
  Told told;
  sut_.clear_fault("right", {}, kHer, keep(told));
  loop_.controls().request_clear(0);
  const Result<api::Done> done = answer_in(told);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, Errc::Busy);
  EXPECT_THAT(done.error().message, HasSubstr("ask again"));
}

TEST_F(Commands, OnlyTheFaultThatIsNamedIsCleared) {
  calibrate();
  stop();
  loop_.controls().is_estop_healthy = true;
  ASSERT_TRUE(clear(1));
  calibrate();
  stop();
  loop_.controls().is_estop_healthy = true;
  ASSERT_EQ(loop_.snapshot().fault.number, 2U);
  for (const std::uint32_t wrong : {1U, 3U, 4294967295U}) {  // an old one, and guesses ahead
    const Result<api::Done> done = clear(wrong);
    ASSERT_FALSE(done) << wrong;
    EXPECT_EQ(done.error().code, Errc::Busy);
    EXPECT_THAT(done.error().message, AllOf(HasSubstr("after fault 2 (estop"),
                                            HasSubstr("not after fault " + std::to_string(wrong))));
    loop_.run(0.1);
    EXPECT_EQ(state(), OperatingState::Fault);
  }
  EXPECT_TRUE(clear(2));
  EXPECT_THAT(clear(2).error().message, HasSubstr("no latched fault"));
}

TEST_F(Commands, AGuessDoesNotWaitForItsFault) {
  calibrate();
  EXPECT_THAT(clear(1).error().message, HasSubstr("no latched fault"));
  stop();
  loop_.controls().is_estop_healthy = true;
  loop_.run(0.1);
  EXPECT_EQ(state(), OperatingState::Fault);
}

TEST_F(Commands, AnUnknownArmIsNamed) {
  Told told;
  sut_.clear_fault("middle", {}, kHer, keep(told));
  for (const auto command : {&app::ArmCommands::activate, &app::ArmCommands::deactivate}) {
    ASSERT_TRUE(told.has_value());
    EXPECT_EQ(told->error().code, Errc::NotFound);
    EXPECT_THAT(told->error().message, HasSubstr("middle"));
    told.reset();
    (sut_.*command)("middle", kHer, keep(told));
  }
  EXPECT_THAT(told.value().error().message, HasSubstr("middle"));
}

}  // namespace
}  // namespace thimble
