// An arm without a watchdog that no program reaches, in front of the circuit that ends its force.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sim/model/falcon/falcon_arm_model.hpp"
#include "tests/scenario/at_each_rate.hpp"
#include "tests/scenario/safety_lab.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using test::SafetyLab;
using testing::HasSubstr;

// The relay of docs/safety-wiring.md, and a Falcon's supply behind it.
class Relay {
 public:
  explicit Relay(SafetyLab& lab) : lab_(lab) {}
  void see() {
    const std::uint64_t changes = lab_.chip.changes(3);
    if (changes != seen_) beaten_at_ = lab_.loop.now();
    seen_ = changes;
    const bool is_closed = lab_.loop.now() - beaten_at_ <= milliseconds(100);
    if (!is_closed) falcon().power_cycle();  // and so it is, in each tick, without power
    was_closed_ = is_closed;
  }
  [[nodiscard]] bool is_closed() const { return was_closed_; }

 private:
  sim::FalconArmModel& falcon() {
    return dynamic_cast<sim::FalconArmModel&>(lab_.loop.sim_arm().backend());
  }

  SafetyLab& lab_;
  std::uint64_t seen_{0};
  MonotonicTime beaten_at_{};
  bool was_closed_{false};
};

std::vector<std::string> with_falcon(std::vector<std::string> overrides) {
  overrides.emplace_back("arm.0.device=sim:falcon-loaded");
  return overrides;
}

sim::ScriptedFault stall_after(Duration from, Duration lasts = Duration::max()) {
  sim::ScriptedFault stall;
  stall.kind = sim::FaultKind::Stall;
  stall.from = MonotonicTime{from};
  stall.lasts = lasts;
  return stall;
}

test::ClosedLoop::Setup setup_of(const sim::ScriptedFault& fault) {
  test::ClosedLoop::Setup setup;
  setup.cables.script.push_back(fault);
  return setup;
}

class OutOfReach : public test::AtEachRate {};
THIMBLE_AT_EACH_RATE(OutOfReach);

// No watchdog of its own, nothing that could reach it: the hardware ends its force.
TEST_P(OutOfReach, AFalconWhoseCableIsPulledWhileItPushesLosesItsPower) {
  SafetyLab sut(with(with_falcon(test::kPoking)));
  Relay relay(sut);
  sut.start();
  sut.run(0.2, [&] { relay.see(); });
  ASSERT_TRUE(sut.run_until(8, [&] {
    relay.see();
    return sut.is_pushed() && norm(sut.loop.truth().motor_force) > 0.05;
  }));
  sut.loop.unplug(sim::Supply::Stays);
  sut.run(0.05, [&] { relay.see(); });
  EXPECT_GT(norm(sut.loop.truth().motor_force), 0.05) << "the last one";
  EXPECT_EQ(sut.safety.status().cause, safety::ChainTrouble::ArmOutOfReach);
  EXPECT_THAT(sut.safety.explanation(), HasSubstr("look at that arm"));
  EXPECT_TRUE(sut.run_until(0.15, [&] {
    relay.see();
    return norm(sut.loop.truth().motor_force) == 0;
  }));
  EXPECT_FALSE(relay.is_closed());
  const Result<api::Done> early = sut.clear();
  ASSERT_FALSE(early);
  EXPECT_THAT(early.error().message, HasSubstr("look at that arm, then clear (arm 'right')"));
  sut.run(0.5, [&] { relay.see(); });
  EXPECT_FALSE(relay.is_closed()) << "too soon";

  // It may need its power to be seen again.
  sut.run(0.5, [&] { relay.see(); });
  const Result<api::Done> refused = sut.clear();
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("the safety lines are let go"));
  EXPECT_TRUE(sut.run_until(0.1, [&] {
    relay.see();
    return relay.is_closed();
  }));
  EXPECT_EQ(sut.safety.status().stops, 1U) << "once for one loss";
  EXPECT_EQ(norm(sut.loop.truth().motor_force), 0);
}

TEST_P(OutOfReach, SoDoesOneWhoseBusHangs) {
  const sim::ScriptedFault hang = stall_after(std::chrono::seconds(20));
  SafetyLab sut(with(with_falcon({"arm.hand.motion=still"})), setup_of(hang));
  Relay relay(sut);
  ASSERT_TRUE(sut.clear_and_hold());
  ASSERT_TRUE(sut.run_until(8, [&] { return sut.loop.frame().gain == 1; }));
  sut.loop.sim_arm().backend().push_tip({4.5, 0, 0});
  const auto see = [&] { relay.see(); };
  while (sut.loop.now() < hang.from) {
    sut.tick();
    see();
  }
  ASSERT_GT(norm(sut.loop.truth().motor_force), 0.05);
  sut.run(0.1, see);
  EXPECT_GT(norm(sut.loop.truth().motor_force), 0.05) << "zero does not come through";
  EXPECT_TRUE(sut.run_until(0.3, [&] {
    see();
    return norm(sut.loop.truth().motor_force) == 0;
  }));
  EXPECT_EQ(sut.safety.status().cause, safety::ChainTrouble::ArmOutOfReach);
}

// Silence that ends is the servo's own affair, and one lost answer is none.
TEST_P(OutOfReach, AFalconThatAnswersAgainAfterAFaultKeepsItsPower) {
  const sim::ScriptedFault silence = stall_after(std::chrono::seconds(20), milliseconds(90));
  SafetyLab sut(with(with_falcon({"arm.hand.motion=still"})), setup_of(silence));
  ASSERT_TRUE(sut.clear_and_hold());
  ASSERT_TRUE(sut.run_until(8, [&] { return sut.loop.frame().gain == 1; }));
  ASSERT_TRUE(sut.run_until(20, [&] { return sut.loop.frame().state == OperatingState::Fault; }));
  sut.run(1);
  EXPECT_EQ(sut.safety.status().stops, 0U);
  EXPECT_TRUE(sut.safety.status().is_enable_beating);
  EXPECT_EQ(norm(sut.loop.truth().motor_force), 0);
}

// It leaves the bus with the power that the button cuts, and comes back with what a clear gives.
TEST_P(OutOfReach, AfterTheButtonAnArmWithoutPowerIsNoReasonToStayStopped) {
  SafetyLab sut(with(with_falcon({"arm.hand.motion=still"})));
  Relay relay(sut);
  const auto see = [&] { relay.see(); };
  ASSERT_TRUE(sut.clear_and_hold());
  ASSERT_TRUE(sut.run_until(8, [&] { return sut.loop.frame().gain == 1; }));
  sut.press(true);
  sut.loop.unplug();
  sut.run(2, see);
  EXPECT_EQ(sut.loop.frame().state, OperatingState::Lost);
  const Result<api::Done> pressed = sut.clear();
  ASSERT_FALSE(pressed);
  EXPECT_THAT(pressed.error().message, HasSubstr("emergency stop is pressed"));
  sut.press(false);
  sut.run(0.1, see);
  const Result<api::Done> released = sut.clear();
  ASSERT_FALSE(released) << "the arm is not there";
  EXPECT_THAT(released.error().message, HasSubstr("plug it in, and clear it when it is back"));
  EXPECT_FALSE(sut.safety.status().is_stopped);
  EXPECT_TRUE(sut.run_until(0.2, [&] {
    see();
    return relay.is_closed();
  }));
}

TEST_P(OutOfReach, OneThatIsNotThereAtTheStartGetsItsPowerFromAClear) {
  SafetyLab sut(with(with_falcon({"arm.hand.motion=still"})));
  sut.loop.unplug();
  sut.run(0.5);
  EXPECT_EQ(sut.loop.frame().state, OperatingState::Lost);
  EXPECT_TRUE(sut.safety.status().is_stopped);
  EXPECT_FALSE(sut.clear());
  EXPECT_FALSE(sut.safety.status().is_stopped);
  sut.run(0.1);
  EXPECT_TRUE(sut.safety.status().is_enable_beating);
}

// Nobody who has another fault in mind lets anything go.
TEST_P(OutOfReach, AClearOfAnotherFaultLetsNothingGo) {
  SafetyLab sut(with(with_falcon({"arm.hand.motion=still"})));
  ASSERT_TRUE(sut.clear_and_hold());
  ASSERT_TRUE(sut.run_until(8, [&] { return sut.loop.frame().gain == 1; }));
  sut.loop.unplug();
  sut.press(true);
  sut.run(0.1);
  sut.press(false);
  sut.run(0.1);
  std::optional<Result<api::Done>> told;
  sut.commands.clear_fault("right", 4711, test::kPerson,
                           [&](const Result<api::Done>& done) { told = done; });
  ASSERT_TRUE(sut.run_until(3, [&] { return told.has_value(); }));
  ASSERT_FALSE(*told);
  EXPECT_THAT(told->error().message, HasSubstr("not after fault 4711"));
  EXPECT_TRUE(sut.safety.status().is_stopped);
}

// What cannot hold a force stops nobody else: let go, never driven, or in a fault for long.
TEST_P(OutOfReach, OneThatWasToldNoForceIsPulledAsItLikes) {
  const auto expect_no_stop = [&](const char* what, const std::function<void(SafetyLab&)>& before) {
    SCOPED_TRACE(what);
    SafetyLab sut(with(with_falcon({"arm.hand.motion=still"})));
    ASSERT_TRUE(sut.clear_and_hold());
    before(sut);
    const std::uint32_t stops = sut.safety.status().stops;
    sut.loop.unplug(sim::Supply::Stays);
    sut.run(1);
    EXPECT_EQ(sut.loop.frame().state, OperatingState::Lost);
    EXPECT_EQ(sut.safety.status().stops, stops);
    EXPECT_TRUE(sut.safety.status().is_enable_beating);
  };
  const auto drive = [](SafetyLab& lab) {
    ASSERT_TRUE(lab.run_until(8, [&] { return lab.loop.frame().gain == 1; }));
    lab.loop.sim_arm().backend().push_tip({4.5, 0, 0});
    lab.run(0.6);
    ASSERT_GT(norm(lab.loop.truth().motor_force), 0.05);
  };
  expect_no_stop("not calibrated yet", [](SafetyLab& lab) {
    lab.loop.sim_arm().backend().hold_tip(nullptr);
    lab.run(0.3);
  });
  expect_no_stop("deactivated", [&](SafetyLab& lab) {
    drive(lab);
    ASSERT_TRUE(lab.leases.release("right"));
    lab.loop.controls().want_active = false;
    lab.run(0.5);
    ASSERT_EQ(lab.loop.frame().state, OperatingState::Inactive);
  });
  expect_no_stop("in a fault of its own", [&](SafetyLab& lab) {
    drive(lab);
    lab.loop.sim_arm().backend().push_tip({-400, 0, 0});
    ASSERT_TRUE(lab.run_until(1, [&] { return lab.loop.frame().state == OperatingState::Fault; }));
    lab.loop.sim_arm().backend().push_tip({});
    lab.run(0.5);
  });
}

// Of an arm that fell silent before it was homed, or rested, nothing is to be ended.
TEST_P(OutOfReach, SilenceOfAnArmThatRestsStopsNobody) {
  const sim::ScriptedFault hang = stall_after(std::chrono::seconds(12));
  SafetyLab sut(with(with_falcon({"arm.hand.motion=still"})), setup_of(hang));
  ASSERT_TRUE(sut.clear_and_hold());
  ASSERT_TRUE(sut.run_until(8, [&] { return sut.loop.frame().gain == 1; }));
  sut.loop.controls().want_active = false;
  ASSERT_TRUE(sut.leases.release("right"));
  ASSERT_TRUE(sut.run_until(20, [&] { return sut.loop.frame().state == OperatingState::Fault; }));
  sut.run(1);
  EXPECT_EQ(sut.safety.status().stops, 0U);
}

// The first fault is another one, and hides that the arm is deaf.
TEST_P(OutOfReach, OneThatIsDeafAfterAnyFaultIsCutAllTheSame) {
  const sim::ScriptedFault hang = stall_after(std::chrono::seconds(12));
  SafetyLab sut(with(with_falcon({"arm.hand.motion=still"})), setup_of(hang));
  ASSERT_TRUE(sut.clear_and_hold());
  ASSERT_TRUE(sut.run_until(8, [&] { return sut.loop.frame().gain == 1; }));
  sut.loop.sim_arm().backend().push_tip({4.5, 0, 0});
  ASSERT_TRUE(sut.run_until(20, [&] { return sut.loop.now() >= hang.from; }));
  sut.loop.controls().is_guarded = false;
  sut.run(0.01);
  EXPECT_EQ(sut.loop.snapshot().fault.code, FaultCode::GuardLost);
  sut.run(0.3);
  EXPECT_EQ(sut.safety.status().cause, safety::ChainTrouble::ArmOutOfReach);
}

}  // namespace
}  // namespace thimble
