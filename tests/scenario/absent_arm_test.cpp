// A real arm that cannot be had when the daemon starts: who is told what, what comes when it
// arrives, and that the arm beside it notices nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <random>

#include "daemon/session/arm_instruction.hpp"
#include "tests/scenario/two_real_arms.hpp"

namespace thimble {
namespace {

using test::kAddresses;
using test::kLeft;
using test::kRight;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

// A try by itself, and the controller's start.
const double kPatience_s = seconds(session::RetryPace::kLongest) + 1.5;

class AbsentArm : public testing::Test, protected test::TwoRealArms {};

TEST_F(AbsentArm, IsLostFromTheStartWhichIsNoStopAndSaysWhatThereIs) {
  plug(kLeft);
  start();
  run(3);
  EXPECT_EQ(state(kLeft), OperatingState::Active);
  EXPECT_EQ(state(kRight), OperatingState::Lost);
  EXPECT_THAT(rig(kRight).trouble(), AllOf(HasSubstr("arm 'right': no device at hid:right"),
                                           HasSubstr("there are: hid:left")));
  EXPECT_EQ(rig(kLeft).trouble(), "");
  EXPECT_EQ(rig(kRight).session().snapshot().fault.code, FaultCode::None);
  EXPECT_FALSE(rig(kRight).session().take_recording());
  EXPECT_THAT(troubles_, IsEmpty()) << "that it is not there is no news";
  EXPECT_THAT(guards_.watched, ElementsAre("hid:left"));
}

TEST_F(AbsentArm, IsOpenedGuardedCalibratedAndFeltWhenItComes) {
  plug(kLeft);
  start();
  run(3.3);  // the next look by itself is more than a second away
  plug(kRight);
  run(0.005);
  EXPECT_EQ(state(kRight), OperatingState::Calibrating) << "at once";
  EXPECT_THAT(guards_.watched, ElementsAre("hid:left", "hid:right"));
  EXPECT_EQ(rig(kRight).trouble(), "");
  EXPECT_EQ(rig(kRight).awaited(), nullptr);
  run(5);
  EXPECT_EQ(state(kRight), OperatingState::Active) << "as its configuration asks";
  EXPECT_GT(rig(kRight).session().snapshot().total_contacts, 0U);
  EXPECT_GT(rig(kRight).session().snapshot().peak_force_newton, 0.5);
  EXPECT_EQ(rig(kRight).session().device().capabilities().peak_current_a[0], 3);
  EXPECT_EQ(forces_unasked_, 0);
}

// Its driver's own, which nobody knows before.
TEST_F(AbsentArm, HasNoRateBeforeItComesUnlessTheConfigurationSaysOne) {
  start();
  EXPECT_FALSE(rig(kRight).session().rate_hz());
  run(0.1);
  plug(kRight);
  run(0.1);
  EXPECT_EQ(rig(kRight).session().rate_hz(), 1000);
  start({"servo.rate_hz=2000"});
  EXPECT_EQ(rig(kRight).session().rate_hz(), 2000);
}

TEST_F(AbsentArm, ThatNobodyWantsActiveAnyMoreStaysInactiveWhenItComes) {
  start();
  rig(kRight).session().controls().want_active = false;  // `thimble deactivate right`
  run(0.5);
  plug(kRight);
  run(5);
  EXPECT_EQ(state(kRight), OperatingState::Inactive);
  EXPECT_EQ(rig(kRight).session().snapshot().peak_force_newton, 0);
  EXPECT_EQ(forces_unasked_, 0);
}

// The driver's last words were of the arm that was pulled.
TEST_F(AbsentArm, ThatWasPulledAsksForNothingButToBeThere) {
  plug(kRight);
  start();
  for (int ms = 0; ms < 5000 && frame(kRight).calibration != CalibrationState::NeedsUser; ++ms) {
    tick();
  }
  ASSERT_EQ(frame(kRight).calibration, CalibrationState::NeedsUser);
  const std::string before = session::instruction_for(rig(kRight));
  ASSERT_THAT(before, AllOf(Not(IsEmpty()), Not(HasSubstr("plug"))));
  unplug(kRight);
  run(1);
  EXPECT_EQ(session::instruction_for(rig(kRight)),
            "hid:right is gone: plug it in again, then calibrate it");
  EXPECT_THAT(session::instruction_for(rig(kLeft)), HasSubstr("no device at hid:left"));
  plug(kRight);
  run(5);
  EXPECT_EQ(session::instruction_for(rig(kRight)), "");
}

TEST_F(AbsentArm, ThatCameAndLeavesIsLostAndReturnsAsAnyOther) {
  start();
  run(0.1);
  plug(kRight);
  run(5);
  ASSERT_EQ(state(kRight), OperatingState::Active);
  unplug(kRight);
  run(1);
  EXPECT_EQ(state(kRight), OperatingState::Lost);
  EXPECT_EQ(rig(kRight).session().snapshot().fault.code, FaultCode::Disconnected);
  EXPECT_EQ(session::instruction_for(rig(kRight)),
            "hid:right is gone: plug it in again, then calibrate it");
  plug(kRight);
  run(5);
  EXPECT_EQ(state(kRight), OperatingState::Fault);
  EXPECT_EQ(session::instruction_for(rig(kRight)),
            "it is calibrated again; to go on: thimble clear-fault right");
  clear(kRight);
  run(0.1);
  EXPECT_EQ(state(kRight), OperatingState::Active);
  EXPECT_EQ(session::instruction_for(rig(kRight)), "");
  EXPECT_EQ(forces_unasked_, 0);
}

struct Tick {
  Position3 tip;
  Force3 force;
  OperatingState state{};
  bool operator==(const Tick&) const = default;
};

// What the left arm does while `happening` befalls the right one.
std::vector<Tick> trace_of_left(const std::function<void(test::TwoRealArms&, int ms)>& happening) {
  test::TwoRealArms lab;
  lab.plug(kLeft);
  lab.start();
  std::vector<Tick> ticks;
  for (int ms = 0; ms < 8000; ++ms) {
    happening(lab, ms);
    lab.tick();
    ticks.push_back({lab.frame(kLeft).tip, lab.frame(kLeft).force, lab.state(kLeft)});
  }
  return ticks;
}

TEST(BesideAnAbsentArm, TheOtherOneDoesTickByTickWhatItDoesAlone) {
  const std::vector<Tick> alone = trace_of_left([](test::TwoRealArms&, int) {});
  const std::vector<Tick> beside = trace_of_left([](test::TwoRealArms& lab, int ms) {
    if (ms == 1000) lab.bus_.refusals["hid:right"] = Errc::Permission;
    if (ms == 1500) lab.plug(kRight);
    if (ms == 3000) lab.bus_.refusals.clear();
    if (ms == 7000) lab.unplug(kRight);
  });
  const auto is_felt = [](const Tick& tick) { return norm(tick.force) > 0.5; };
  EXPECT_GT(std::count_if(alone.begin(), alone.end(), is_felt), 100) << "else this shows nothing";
  EXPECT_TRUE(alone == beside);
}

TEST_F(AbsentArm, ThatSomebodyElseHoldsForLongIsToldAndTriedLessAndLessOften) {
  plug(kLeft);
  plug(kRight);
  bus_.refusals["hid:right"] = Errc::Busy;
  const MonotonicTime begun = clock_.now();
  start();
  EXPECT_EQ(clock_.now() - begun, session::Runtime::kBusyPatience);
  run(3);
  EXPECT_EQ(state(kLeft), OperatingState::Active);
  EXPECT_EQ(state(kRight), OperatingState::Lost);
  EXPECT_THAT(rig(kRight).trouble(), AllOf(HasSubstr("'right'"), HasSubstr("refused today")));
  bus_.tries.clear();
  run(20);
  EXPECT_GE(bus_.tries["hid:right"], 9);
  EXPECT_LE(bus_.tries["hid:right"], 11);
  bus_.refusals.clear();
  run(kPatience_s + 3);
  EXPECT_EQ(state(kRight), OperatingState::Active);
  EXPECT_EQ(rig(kRight).trouble(), "");
}

TEST_F(AbsentArm, ThatMayNotBeOpenedIsToldAtOnceAndTakenOnceItMay) {
  plug(kLeft);
  plug(kRight);
  bus_.refusals["hid:right"] = Errc::Permission;
  const MonotonicTime begun = clock_.now();
  start();
  EXPECT_EQ(clock_.now(), begun) << "no waiting helps";
  run(3);
  EXPECT_EQ(state(kLeft), OperatingState::Active);
  EXPECT_EQ(state(kRight), OperatingState::Lost);
  EXPECT_THAT(rig(kRight).trouble(), HasSubstr("refused today"));
  ASSERT_FALSE(troubles_.empty());
  EXPECT_EQ(troubles_[0].message, rig(kRight).trouble()) << "and so the log has it once";
  bus_.refusals.clear();
  run(kPatience_s + 3);
  EXPECT_EQ(state(kRight), OperatingState::Active);
  EXPECT_EQ(forces_unasked_, 0);
}

// The firmware of a Falcon, say, or what a device tells of itself: a report too long (Unsupported),
// pipes that its driver cannot claim (InvalidArgument), the ids of another one (NotMine).
TEST_F(AbsentArm, WhateverIsWrongWithItOrItsFilesEndsNoOtherArmsStart) {
  plug(kLeft);
  plug(kRight);
  for (const Errc code : {Errc::Malformed, Errc::TooLarge, Errc::Unsupported, Errc::InvalidArgument,
                          Errc::NotMine, Errc::Disconnected, Errc::Timeout, Errc::System}) {
    bus_.refusals["hid:right"] = code;
    start();
    run(3);
    EXPECT_EQ(state(kLeft), OperatingState::Active);
    EXPECT_EQ(state(kRight), OperatingState::Lost);
    EXPECT_THAT(rig(kRight).trouble(), HasSubstr("refused today"));
    bus_.refusals.clear();
    run(kPatience_s + 3);
    EXPECT_EQ(state(kRight), OperatingState::Active) << "once they are mended";
  }
}

TEST_F(AbsentArm, WhoseDriverThrowsIsLostAndToldAndHarmsNobody) {
  plug(kLeft);
  bus_.throwing = {"hid:right"};
  for (const bool is_there_at_the_start : {false, true}) {
    if (is_there_at_the_start) plug(kRight);
    start();
    if (!is_there_at_the_start) plug(kRight);
    run(3);
    EXPECT_EQ(state(kLeft), OperatingState::Active);
    EXPECT_EQ(state(kRight), OperatingState::Lost);
    EXPECT_THAT(rig(kRight).trouble(), HasSubstr("arm 'right': hid:right: hid:right broke"));
    unplug(kRight);
  }
  bus_.throwing.clear();
  plug(kRight);
  run(kPatience_s + 3);
  EXPECT_EQ(state(kRight), OperatingState::Active);
  EXPECT_EQ(forces_unasked_, 0);
}

TEST_F(AbsentArm, InWhosePlaceAnotherDeviceStandsIsWaitedFor) {
  plug(kLeft);
  plug(kRight);
  bus_.vendors["hid:right"] = 0x0001;
  start();
  run(3);
  EXPECT_EQ(state(kLeft), OperatingState::Active);
  EXPECT_EQ(state(kRight), OperatingState::Lost);
  EXPECT_THAT(rig(kRight).trouble(), HasSubstr("no driver knows the device at hid:right"));
  EXPECT_EQ(bus_.tries["hid:right"], 0) << "nothing is sent to a stranger";
  bus_.vendors.clear();
  run(kPatience_s + 3);
  EXPECT_EQ(state(kRight), OperatingState::Active);
}

TEST_F(AbsentArm, ThatComesAsAnotherModelThanTheConfigurationSaysIsRefused) {
  start({"arm.1.model=falcon"});
  run(0.1);
  plug(kRight);
  run(3);
  EXPECT_EQ(state(kRight), OperatingState::Lost);
  EXPECT_EQ(bus_.tries["hid:right"], 0);
  EXPECT_THAT(rig(kRight).trouble(),
              AllOf(HasSubstr("'right'"), HasSubstr("the model 'falcon' is unknown")));
}

TEST_F(AbsentArm, WhoseGuardCannotBeHadStaysLostUntilItCan) {
  start();
  run(0.1);
  guards_.is_refusing = true;
  plug(kRight);
  run(3);
  EXPECT_EQ(state(kRight), OperatingState::Lost);
  EXPECT_THAT(rig(kRight).trouble(), AllOf(HasSubstr("guard"), HasSubstr("does not answer")));
  guards_.is_refusing = false;
  run(kPatience_s + 3);
  EXPECT_EQ(state(kRight), OperatingState::Active);
  EXPECT_THAT(guards_.watched, ElementsAre("hid:right"));
}

TEST_F(AbsentArm, ThatIsAnotherModelThanTheConfigurationSaysEndsNoOtherArmsStart) {
  plug(kLeft);
  plug(kRight);
  start({"arm.1.model=spacemouse"});
  run(3);
  EXPECT_EQ(state(kLeft), OperatingState::Active);
  EXPECT_EQ(state(kRight), OperatingState::Lost);
  EXPECT_THAT(rig(kRight).trouble(), AllOf(HasSubstr("'right'"), HasSubstr("spacemouse")));
}

// What no other device can mend.
TEST_F(AbsentArm, EndsTheStartWhereItsWorldIsWrong) {
  plug(kRight);
  const auto made = make({"arm.1.coupling.scheme=thesis-literal", "world.0.source=sphere",
                          "world.0.sphere.radius_m=0.02"});
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().message, AllOf(HasSubstr("'right'"), HasSubstr("coupling.scheme")));
}

TEST_F(AbsentArm, WhoseOpeningLastsHoldsUpNobodyAndIsFeltInTheEnd) {
  plug(kLeft);
  is_work_postponed_ = true;
  start();
  run(1);
  plug(kRight);
  run(6);
  EXPECT_EQ(work_[kRight].waiting(), 1U) << "one search at a time, however long it lasts";
  EXPECT_EQ(state(kLeft), OperatingState::Active);
  EXPECT_GT(rig(kLeft).session().snapshot().total_contacts, 0U);
  EXPECT_EQ(state(kRight), OperatingState::Lost);
  work_[kRight].do_all();
  run(5);
  EXPECT_EQ(state(kRight), OperatingState::Active);
  EXPECT_EQ(forces_unasked_, 0);
}

TEST_F(AbsentArm, ThatLeavesWhileItIsOpenedIsLookedForAgain) {
  is_work_postponed_ = true;
  start();
  work_[kRight].do_all();
  run(2.5);
  plug(kRight);
  run(0.1);
  work_[kRight].do_all();  // it is open, but nobody has asked yet whether it is
  unplug(kRight);
  run(2.5);
  EXPECT_EQ(state(kRight), OperatingState::Lost);
  plug(kRight);
  for (int i = 0; i < 500; ++i) {
    run(0.01);
    work_[kRight].do_all();
  }
  EXPECT_EQ(state(kRight), OperatingState::Active);
  EXPECT_EQ(forces_unasked_, 0);
}

// Random plugs, pulls and refusals against the simplest oracle: an arm is lost if and only if it
// cannot be had.
class AbsentArmsAtRandom : public AbsentArm, public testing::WithParamInterface<unsigned> {};

TEST_P(AbsentArmsAtRandom, AreLostAsLongAsTheyCannotBeHadAndNoLonger) {
  is_work_postponed_ = GetParam() % 2 == 0;
  std::mt19937 random(GetParam());
  const auto any = [&](unsigned below) { return static_cast<unsigned>(random() % below); };
  constexpr Errc kRefusals[] = {Errc::Busy,    Errc::Permission,   Errc::System,    Errc::NotFound,
                                Errc::Timeout, Errc::Disconnected, Errc::Malformed, Errc::TooLarge};
  bool is_plugged[2]{};
  const auto happen = [&] {
    const std::size_t arm = any(2);
    switch (any(3)) {
      case 0:
        if (is_plugged[arm]) {
          unplug(arm);
        } else {
          plug(arm);
        }
        is_plugged[arm] = !is_plugged[arm];
        break;
      case 1:
        bus_.refusals[kAddresses[arm]] = kRefusals[any(std::size(kRefusals))];
        break;
      default:
        bus_.refusals.erase(kAddresses[arm]);
    }
  };
  for (int i = 0; i < 4; ++i) happen();
  start();
  for (int round = 0; round < 5; ++round) {
    for (int i = 0; i < 6; ++i) {
      happen();
      run(0.001 * (1 + any(600)));
      for (test::PostponedExecutor& work : work_) {
        for (unsigned tasks = any(3); tasks > 0; --tasks) work.do_one();
      }
    }
    // A refusal harms nobody who is open already, and so has its turn once more.
    for (std::size_t arm = 0; arm < 2; ++arm) {
      const bool is_refused = bus_.refusals.count(kAddresses[arm]) > 0;
      if (!is_refused || !is_plugged[arm]) continue;
      unplug(arm);
      run(0.01);
      plug(arm);
    }
    for (int i = 0; i < 100; ++i) {
      for (test::PostponedExecutor& work : work_) work.do_all();
      run(kPatience_s / 100);
    }
    for (std::size_t arm = 0; arm < 2; ++arm) {
      const bool can_be_had = is_plugged[arm] && bus_.refusals.count(kAddresses[arm]) == 0;
      EXPECT_EQ(state(arm) != OperatingState::Lost, can_be_had) << "arm " << arm;
    }
  }
  EXPECT_EQ(forces_unasked_, 0);
}
INSTANTIATE_TEST_SUITE_P(Seeds, AbsentArmsAtRandom, testing::Range(1U, 9U));

}  // namespace
}  // namespace thimble
