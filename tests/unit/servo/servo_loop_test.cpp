#include "daemon/servo/servo_loop.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/unit/servo/scripted_rig.hpp"

namespace thimble::servo {
namespace {

TEST(ServoLoop, GivesNoForceBeforeCalibration) {
  ServoRig rig;
  rig.device.state.calibration = CalibrationState::NeedsUser;
  rig.coupling.wish = {2, 0, 0};
  rig.controls.want_active = true;

  rig.tick(1000);

  EXPECT_EQ(rig.state(), OperatingState::Calibrating);
  EXPECT_EQ(rig.coupling.steps, 0);
  for (const Force3& force : rig.device.written) ASSERT_EQ(force, Force3{});
}

TEST(ServoLoop, ReadsAndWritesZeroWhileInactive) {
  ServoRig rig;
  rig.coupling.wish = {2, 0, 0};
  rig.device.state.tip = {0.01, 0.02, 0.03};

  rig.tick(100);

  EXPECT_EQ(rig.state(), OperatingState::Inactive);
  EXPECT_EQ(rig.snapshot().frame.tip, (Position3{0.01, 0.02, 0.03}));
  EXPECT_EQ(rig.device.written.size(), 100U);
  for (const Force3& force : rig.device.written) ASSERT_EQ(force, Force3{});
}

TEST(ServoLoop, RampsTheForceInOverHalfASecondOnActivation) {
  ServoRig rig;
  rig.coupling.wish = {4, 0, 0};
  rig.controls.want_active = true;
  rig.tick(10);
  ASSERT_EQ(rig.state(), OperatingState::Active);
  rig.device.written.clear();

  rig.tick(600);

  EXPECT_LT(rig.device.written[100].x, 1.2);
  EXPECT_NEAR(rig.device.written[250].x, 2.0, 0.2);
  EXPECT_EQ(rig.device.written.back().x, 4);
}

TEST(ServoLoop, TheGhostRestartsAtTheHandOnActivation) {
  ServoRig rig;
  rig.device.state.tip = {0.01, 0, 0};
  rig.activate_fully();
  EXPECT_EQ(rig.coupling.resets, 1);
  EXPECT_EQ(rig.coupling.reset_tip, (Position3{0.01, 0, 0}));
}

TEST(ServoLoop, CountsEveryPressInTheSamplesThatFollow) {
  DrivenRig rig;
  EXPECT_FALSE(rig.link.sent.back().has_presses);
  for (int press = 1; press <= 300; ++press) {
    rig.device.state.buttons = 0b10;
    rig.tick(2);
    rig.device.state.buttons = 0;
    rig.tick();
    const coupling::HandSample& told = rig.link.sent.back();
    ASSERT_TRUE(told.has_presses);
    ASSERT_EQ(told.presses, (coupling::PressCounts{0, static_cast<std::uint8_t>(press)}));
  }
}

TEST(ServoLoop, CountsWhatIsAskedOfTheWorldInTheSamplesThatFollow) {
  DrivenRig rig;
  EXPECT_FALSE(rig.link.sent.back().has_actions);
  for (int asked = 1; asked <= 300; ++asked) {
    rig.controls.actions.ask(world::HandAction::Reset);
    rig.tick(2);
    const coupling::HandSample& told = rig.link.sent.back();
    ASSERT_TRUE(told.has_actions);
    ASSERT_EQ(told.actions, (coupling::ActionCounts{0, static_cast<std::uint8_t>(asked)}));
  }
}

TEST(ServoLoop, RampsDownOnDeactivation) {
  DrivenRig rig;
  rig.controls.want_active = false;
  rig.device.written.clear();

  rig.tick(25);

  EXPECT_NEAR(rig.device.written[9].x, 2, 0.3);
  EXPECT_EQ(rig.device.written[20].x, 0);
  EXPECT_EQ(rig.state(), OperatingState::Inactive);
}

TEST(ServoLoop, HoldsThenRampsThenFaultsWhenSamplesStop) {
  DrivenRig rig;
  rig.device.next_status = IoStatus::NoData;
  rig.device.written.clear();

  rig.tick(3);
  EXPECT_EQ(rig.device.written.back().x, 4) << "held";
  rig.tick(10);
  EXPECT_NEAR(rig.device.written.back().x, 2, 0.3) << "ramping";
  rig.tick(7);
  EXPECT_EQ(rig.state(), OperatingState::Fault);
  EXPECT_EQ(rig.snapshot().fault.code, FaultCode::StaleSample);
  EXPECT_EQ(rig.device.written.back(), Force3{});
}

TEST(ServoLoop, TheGhostRestartsAtTheHandAfterAnOutage) {
  ServoRig rig;
  rig.activate_fully();
  rig.device.next_status = IoStatus::NoData;
  rig.tick(6);
  rig.device.next_status = IoStatus::Ok;
  rig.device.state.tip = {0, 0.004, 0};

  rig.tick(1);

  EXPECT_EQ(rig.coupling.resets, 2);
  EXPECT_EQ(rig.coupling.reset_tip, (Position3{0, 0.004, 0}));
}

TEST(ServoLoop, OverspeedLatchesAndCutsTheForce) {
  DrivenRig rig;
  for (int i = 0; i < 30 && rig.state() == OperatingState::Active; ++i) {
    rig.device.state.tip.x += 0.002;  // 2 m/s
    rig.tick();
  }
  EXPECT_EQ(rig.snapshot().fault.code, FaultCode::Overspeed);
  EXPECT_EQ(rig.device.written.back(), Force3{});
}

TEST(ServoLoop, ANonFiniteWishLatchesAndNeverReachesTheArm) {
  ServoRig rig;
  rig.coupling.wish = {1, 0, 0};
  rig.activate_fully();
  rig.coupling.wish.y = std::numeric_limits<double>::quiet_NaN();

  rig.tick();

  EXPECT_EQ(rig.snapshot().fault.code, FaultCode::NonFiniteForce);
  EXPECT_EQ(rig.device.written.back(), Force3{});
}

TEST(ServoLoop, ANonFinitePositionLatches) {
  ServoRig rig;
  rig.activate_fully();
  rig.device.state.tip.z = std::numeric_limits<double>::infinity();
  rig.tick();
  EXPECT_EQ(rig.snapshot().fault.code, FaultCode::NonFiniteState);
}

TEST(ServoLoop, AnEstopCutsInTheTickThatSeesIt) {
  DrivenRig rig;
  rig.controls.is_estop_healthy = false;
  rig.tick();
  EXPECT_EQ(rig.device.written.back(), Force3{});
  EXPECT_EQ(rig.snapshot().fault.code, FaultCode::Estop);
}

TEST(ServoLoop, AReleasedDeadmanRampsToZeroWithinTwentyMilliseconds) {
  DrivenRig rig;
  rig.controls.is_deadman_held = false;
  rig.tick(20);
  EXPECT_EQ(rig.device.written.back(), Force3{});
  EXPECT_EQ(rig.state(), OperatingState::Active) << "no fault: pressing it again ramps in";
}

TEST(ServoLoop, ALatchedFaultIsZeroThenSilenceUntilAPersonClearsIt) {
  DrivenRig rig;
  rig.press_estop();
  rig.device.written.clear();

  rig.tick(500);
  EXPECT_NEAR(static_cast<double>(rig.device.written.size()), 100, 1);
  for (const Force3& force : rig.device.written) ASSERT_EQ(force, Force3{});
  EXPECT_EQ(rig.state(), OperatingState::Fault);

  rig.controls.request_clear(rig.snapshot().fault.number);
  rig.device.written.clear();
  rig.tick(50);
  EXPECT_EQ(rig.state(), OperatingState::Active) << "the lease still stands";
  EXPECT_LT(rig.device.written.back().x, 0.5) << "ramped from zero";
}

TEST(ServoLoop, TheFirstFaultWins) {
  ServoRig rig;
  rig.activate_fully();
  rig.controls.is_estop_healthy = false;
  rig.tick();
  rig.device.state.tip.x = std::nan("");
  rig.tick();
  EXPECT_EQ(rig.snapshot().fault.code, FaultCode::Estop);
  EXPECT_EQ(rig.snapshot().faults, 1U);
}

TEST(ServoLoop, EveryLatchedStopFreezesARecordingThatEndsWithTheFault) {
  DrivenRig rig;
  rig.controls.is_estop_healthy = false;
  rig.tick(3);

  ASSERT_TRUE(rig.sut.recorder().is_frozen());
  const std::vector<ServoFrame> frames = rig.sut.recorder().take().frames;

  ASSERT_GT(frames.size(), 500U);
  EXPECT_EQ(frames.back().fault, FaultCode::Estop);
  EXPECT_EQ(frames.back().force, Force3{});
  EXPECT_EQ(frames[frames.size() - 2].force.x, 4);
}

TEST(ServoLoop, ASecondStopBeforeTheFirstIsTakenHasARecordingOfItsOwn) {
  ServoRig rig;
  rig.activate_fully();
  rig.controls.is_estop_healthy = false;
  rig.tick();
  rig.device.next_status = IoStatus::Disconnected;
  rig.tick();

  const FlightStop first = rig.sut.recorder().take();
  const FlightStop second = rig.sut.recorder().take();

  EXPECT_EQ(first.cause.code, FaultCode::Estop);
  EXPECT_EQ(second.cause.code, FaultCode::Disconnected);
  ASSERT_EQ(second.frames.size(), 1U);
  EXPECT_EQ(second.frames.back().tick, first.frames.back().tick + 1);
  EXPECT_FALSE(rig.sut.recorder().is_frozen());
}

TEST(ServoLoop, TwoStopsInOneTickHaveTwoRecordings) {
  ServoRig rig;
  rig.activate_fully();
  rig.controls.is_estop_healthy = false;
  rig.device.next_status = IoStatus::Disconnected;
  rig.tick();

  const FlightStop first = rig.sut.recorder().take();
  const FlightStop second = rig.sut.recorder().take();

  EXPECT_EQ(first.cause.code, FaultCode::Estop);
  EXPECT_EQ(second.cause.code, FaultCode::Disconnected);
  ASSERT_FALSE(first.frames.empty());
  ASSERT_FALSE(second.frames.empty());
  EXPECT_EQ(first.frames.back().tick, second.frames.back().tick);
}

TEST(ServoLoop, UnplugMeansLostAndNoFurtherWrites) {
  ServoRig rig;
  rig.activate_fully();
  rig.device.next_status = IoStatus::Disconnected;
  rig.device.written.clear();

  rig.tick(50);

  EXPECT_EQ(rig.state(), OperatingState::Lost);
  EXPECT_TRUE(rig.device.written.empty());
  EXPECT_EQ(rig.snapshot().fault.code, FaultCode::Disconnected);
  EXPECT_TRUE(rig.sut.recorder().is_frozen());
}

TEST(ServoLoop, AFaultOutlivesAnUnplug) {
  ServoRig rig;
  rig.activate_fully();
  rig.press_estop();
  rig.device.next_status = IoStatus::Disconnected;
  rig.tick();
  rig.device.next_status = IoStatus::Ok;
  rig.tick(5);
  EXPECT_EQ(rig.state(), OperatingState::Fault);
  EXPECT_EQ(rig.snapshot().fault.code, FaultCode::Estop);
}

TEST(ServoLoop, LosingTheReferenceWhileDrivenLatches) {
  ServoRig rig;
  rig.coupling.wish = {1, 0, 0};
  rig.activate_fully();
  rig.device.state.calibration = CalibrationState::NeedsUser;
  rig.tick();
  EXPECT_EQ(rig.snapshot().fault.code, FaultCode::LostReference);
  EXPECT_EQ(rig.device.written.back(), Force3{});
}

TEST(ServoLoop, AServoThatWasAwayForTwentyMillisecondsFaults) {
  ServoRig rig;
  rig.activate_fully();
  rig.clock.advance(std::chrono::milliseconds(20));
  rig.tick();
  EXPECT_EQ(rig.snapshot().fault.code, FaultCode::ServoLate);
}

TEST(ServoLoop, ShortLatenessIsCountedAndIsNoFaultUnlessRealtimeIsRequired) {
  ServoRig lenient;
  lenient.activate_fully();
  lenient.clock.advance(std::chrono::milliseconds(2));
  lenient.sut.tick(std::chrono::milliseconds(2));
  EXPECT_EQ(lenient.state(), OperatingState::Active);
  EXPECT_EQ(lenient.snapshot().overruns, 2U);

  ServoSettings settings;
  settings.is_realtime_required = true;
  ServoRig strict(settings);
  strict.activate_fully();
  strict.clock.advance(std::chrono::milliseconds(2));
  strict.sut.tick(std::chrono::milliseconds(2));
  EXPECT_EQ(strict.snapshot().fault.code, FaultCode::ServoLate);
}

TEST(ServoLoop, WhereRealtimeIsRequiredAFasterServoIsNoSoonerLate) {
  using namespace std::chrono_literals;
  struct Case {
    double rate_hz;
    std::chrono::microseconds least;  // between two ticks, that are a fault
  };
  for (const Case& one : {Case{500, 4000us}, {1000, 2000us}, {2000, 1500us}, {4000, 1250us}}) {
    for (const auto less : {1us, 0us}) {
      ServoSettings settings;
      settings.rate_hz = one.rate_hz;
      settings.is_realtime_required = true;
      ServoRig rig(settings);
      rig.activate_fully();
      rig.clock.advance(one.least - less);
      rig.sut.tick(one.least - less);
      const FaultCode expected = less == 0us ? FaultCode::ServoLate : FaultCode::None;
      EXPECT_EQ(rig.snapshot().fault.code, expected) << one.rate_hz;
    }
  }
}

TEST(ServoLoop, SendsOneHandSamplePerReportOfTheArm) {
  ServoSettings settings;
  settings.rate_hz = 4000;
  ServoRig rig(settings);
  rig.activate_fully();
  rig.link.sent.clear();
  for (int i = 0; i < 400; ++i) {
    rig.device.next_status = i % 4 == 0 ? IoStatus::Ok : IoStatus::NoData;
    rig.tick();
  }
  EXPECT_EQ(rig.link.sent.size(), 100U);
}

TEST(ServoLoop, AReplyFromBeforeThePauseIsNotAppliedOnActivation) {
  ServoRig rig;
  rig.activate_fully();
  rig.controls.want_active = false;
  rig.tick(50);
  rig.coupling.replies = 0;
  rig.link.has_reply = true;

  rig.controls.want_active = true;
  rig.tick(10);

  EXPECT_EQ(rig.state(), OperatingState::Active);
  EXPECT_EQ(rig.coupling.replies, 0);
  rig.link.has_reply = true;
  rig.tick();
  EXPECT_EQ(rig.coupling.replies, 1) << "what comes afterwards counts";
}

TEST(ServoLoop, ALostArmIsNotShownAsCalibrated) {
  ServoRig rig;
  rig.activate_fully();
  rig.device.next_status = IoStatus::Disconnected;
  rig.tick(2);
  EXPECT_EQ(rig.snapshot().frame.calibration, CalibrationState::Unknown);
}

}  // namespace
}  // namespace thimble::servo
