#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/campaign/good_course.hpp"

// Every invariant is seen to hold on a good course and to break on a planted breach.
namespace thimble::campaign {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

TEST(SentForce, HoldsOnAGoodCourse) { EXPECT_EQ(GoodCourse(&make_sent_force).broken(), ""); }

TEST(SentForce, SeesWhatIsNotFinite) {
  for (const auto spoil : {+[](Observation& now) { now.servo.frame.force.y = kNotANumber; },
                           +[](Observation& now) { now.servo.frame.tip.x = kNotANumber; },
                           +[](Observation& now) { now.servo.frame.offset.z = 1.0 / 0.0; },
                           +[](Observation& now) { now.servo.frame.gain = kNotANumber; }}) {
    GoodCourse course(&make_sent_force);
    course.run(1, spoil);
    EXPECT_THAT(course.broken(), HasSubstr("finite"));
  }
}

TEST(SentForce, SeesANormBeyondTheLimit) {
  GoodCourse course(&make_sent_force);
  double newton = 1;
  course.run(20, [&](Observation& now) { now.servo.frame.force = {newton += 0.3, 0, 0}; });
  EXPECT_THAT(course.broken(), HasSubstr("norm"));
}

TEST(SentForce, SeesARiseAndAReversalThatAreTooFastButNoFall) {
  GoodCourse falls(&make_sent_force);
  falls.run(1, [](Observation& now) { now.servo.frame.force = {}; });
  EXPECT_EQ(falls.broken(), "");
  for (const Force3 jump : {Force3{2.1, 0, 0}, Force3{-1.1, 0, 0}, Force3{1, 1.1, 0}}) {
    GoodCourse course(&make_sent_force);
    course.run(1, [&](Observation& now) { now.servo.frame.force = jump; });
    EXPECT_THAT(course.broken(), HasSubstr("rise"));
  }
}

TEST(SentForce, SeesThatALateTickMakesUpForItsRise) {
  GoodCourse course(&make_sent_force);
  course.run(1, [](Observation& now) {
    now.servo.frame.dt = milliseconds(20);
    now.servo.frame.force = {4, 0, 0};
  });
  EXPECT_THAT(course.broken(), HasSubstr("rise"));
}

TEST(SentForce, SeesForceWhileNotActive) {
  GoodCourse course(&make_sent_force);
  course.run(1, [](Observation& now) { now.servo.frame.state = OperatingState::Inactive; });
  EXPECT_THAT(course.broken(), HasSubstr("while not Active"));
}

TEST(ZeroAfterStop, HoldsOnAGoodCourse) {
  GoodCourse course(&make_zero_after_stop);
  course.stop(OperatingState::Fault, FaultCode::Estop);
  course.run(700);
  EXPECT_EQ(course.broken(), "");
}

TEST(ZeroAfterStop, SeesAStopThatIsNotWritten) {
  GoodCourse course(&make_zero_after_stop);
  course.stop(OperatingState::Fault, FaultCode::Estop);
  course.run(1, [](Observation& now) { now.servo.frame.write_status = IoStatus::NoData; });
  EXPECT_THAT(course.broken(), HasSubstr("its own tick"));
}

TEST(ZeroAfterStop, SeesAReportThatAsksForCurrent) {
  GoodCourse course(&make_zero_after_stop);
  course.stop(OperatingState::Fault, FaultCode::Estop);
  course.run(50);
  course.run(1, [](Observation& now) { now.wire.last_nonzero = now.servo.frame.now; });
  EXPECT_THAT(course.broken(), HasSubstr("asks for current"));
}

TEST(ZeroAfterStop, ExcusesBytesSpoiltOnTheWayThoughTheServoWakesLate) {
  for (const bool is_spoilt : {true, false}) {
    GoodCourse course(&make_zero_after_stop);
    course.stop(OperatingState::Fault, FaultCode::Estop);
    course.run(50);
    course.run(1, [&](Observation& now) { now.spoilt_out += is_spoilt ? 1 : 0; });
    const MonotonicTime arrived = course.now.servo.frame.now + std::chrono::milliseconds(1);
    const auto late = [&](Observation& now) {
      now.servo.frame.now = now.servo.frame.now + std::chrono::milliseconds(29);
      now.wire.last_nonzero = arrived;
    };
    course.run(1, late);
    EXPECT_EQ(course.broken().find("asks for current") == std::string::npos, is_spoilt);
  }
}

// A current that was written before the stop and comes after it.
void arrive_late(GoodCourse& course, bool is_known) {
  course.stop(OperatingState::Fault, FaultCode::Estop);
  course.run(20, [&](Observation& now) {
    if (is_known) now.late_out_at = now.servo.frame.now;
    now.wire.last_nonzero = now.wire.last_report = now.servo.frame.now;
    now.truth.motor_current_a = {1, 0, 0};
  });
}

TEST(ZeroAfterStop, ExcusesReportsThatAreLateUntilTheZeroArrives) {
  GoodCourse unknown(&make_zero_after_stop);
  arrive_late(unknown, false);
  EXPECT_THAT(unknown.broken(), HasSubstr("asks for current"));
  GoodCourse course(&make_zero_after_stop);
  arrive_late(course, true);
  course.run(100);
  EXPECT_EQ(course.broken(), "");
  GoodCourse driven(&make_zero_after_stop);
  arrive_late(driven, true);
  driven.run(10, [](Observation& now) { now.truth.motor_current_a = {1, 0, 0}; });
  EXPECT_THAT(driven.broken(), HasSubstr("motor"));
}

TEST(ZeroAfterStop, SeesAMotorThatGoesOn) {
  GoodCourse course(&make_zero_after_stop);
  course.stop(OperatingState::Fault, FaultCode::Estop);
  course.run(10, [](Observation& now) { now.truth.motor_current_a = {0.01, 0, 0}; });
  EXPECT_THAT(course.broken(), HasSubstr("motor"));
}

TEST(ZeroAfterStop, WaitsForTheWatchdogOfAnArmThatHearsNothing) {
  GoodCourse course(&make_zero_after_stop);
  const MonotonicTime last = course.now.wire.last_report;
  course.stop(OperatingState::Fault, FaultCode::StaleSample);
  const auto deaf = [&](Observation& now) {
    now.wire.last_report = now.wire.last_nonzero = last;
    now.truth.motor_current_a = {1, 0, 0};
  };
  course.run(490, deaf);
  EXPECT_EQ(course.broken(), "");
  course.run(20, deaf);
  EXPECT_THAT(course.broken(), HasSubstr("motor"));
}

TEST(Latch, HoldsOnAGoodCourse) {
  GoodCourse course(&make_latch);
  course.stop(OperatingState::Fault, FaultCode::Estop);
  course.run(10);
  EXPECT_EQ(course.broken(), "");
}

// What a person's granted request looks like.
void clear(Observation& now) {
  now.clear_asked = ++now.servo.clear_answered;
  now.servo.clear_outcome = ClearOutcome::Cleared;
  now.servo.frame.fault = FaultCode::None;
  now.servo.frame.state = OperatingState::Configured;
}

TEST(Latch, EndsByAGrantedRequestOnly) {
  GoodCourse granted(&make_latch);
  granted.stop(OperatingState::Fault, FaultCode::Estop);
  granted.run(1);
  granted.run(1, clear);
  EXPECT_EQ(granted.broken(), "");
  GoodCourse by_itself(&make_latch);
  by_itself.stop(OperatingState::Fault, FaultCode::Estop);
  by_itself.run(1);
  by_itself.run(1, [](Observation& now) {
    now.servo.frame.fault = FaultCode::None;
    now.servo.frame.state = OperatingState::Configured;
  });
  EXPECT_THAT(by_itself.broken(), HasSubstr("stays latched"));
  GoodCourse groundless(&make_latch);
  groundless.run(1, clear);
  EXPECT_THAT(groundless.broken(), HasSubstr("only a latched fault"));
}

TEST(Latch, SeesAClearThatNobodyMayGet) {
  for (const auto spoil : {+[](Observation& now) { now.is_clear_for_other = true; },
                           +[](Observation& now) { now.is_estop_healthy = false; }}) {
    GoodCourse course(&make_latch);
    course.stop(OperatingState::Fault, FaultCode::Estop);
    course.run(1);
    course.run(1, [&](Observation& now) {
      clear(now);
      spoil(now);
    });
    EXPECT_THAT(course.broken(), HasSubstr("no fault is cleared"));
  }
}

TEST(Latch, SeesALaterFaultThatReplacesTheFirst) {
  GoodCourse course(&make_latch);
  course.stop(OperatingState::Fault, FaultCode::Estop);
  course.run(1);
  course.run(1, [](Observation& now) { now.servo.frame.fault = FaultCode::Overspeed; });
  EXPECT_THAT(course.broken(), HasSubstr("stays latched"));
}

TEST(Latch, SeesFaultAndStateThatDisagree) {
  GoodCourse driven(&make_latch);
  driven.run(1, [](Observation& now) {
    now.servo.frame.fault = FaultCode::Overspeed;
    ++now.servo.faults;
  });
  EXPECT_THAT(driven.broken(), HasSubstr("means Fault or Lost"));
  GoodCourse uncounted(&make_latch);
  uncounted.run(1, [](Observation& now) {
    now.servo.frame.fault = FaultCode::Overspeed;
    now.servo.frame.state = OperatingState::Fault;
  });
  EXPECT_THAT(uncounted.broken(), HasSubstr("counted once"));
  GoodCourse groundless(&make_latch);
  groundless.run(1, [](Observation& now) { now.servo.frame.state = OperatingState::Fault; });
  EXPECT_THAT(groundless.broken(), HasSubstr("Fault means a fault"));
}

TEST(Latch, LetsAnArmThatWasUnpluggedComeBackAndBeCalibratedBeforeItsClear) {
  for (const FaultCode code : {FaultCode::Disconnected, FaultCode::StaleSample}) {
    GoodCourse course(&make_latch);
    course.stop(OperatingState::Lost, code);
    for (const OperatingState state :
         {OperatingState::Lost, OperatingState::Configured, OperatingState::Calibrating,
          OperatingState::Fault, OperatingState::Calibrating, OperatingState::Fault}) {
      course.now.servo.frame.state = state;
      course.run(3);
    }
    course.run(1, clear);
    EXPECT_EQ(course.broken(), "");
  }
}

TEST(Latch, SeesAPulledArmThatIsClearedBeforeItIsCalibrated) {
  GoodCourse course(&make_latch);
  course.stop(OperatingState::Lost, FaultCode::Disconnected);
  course.run(1);
  course.run(1, [](Observation& now) {
    clear(now);
    now.servo.frame.calibration = CalibrationState::NeedsUser;
  });
  EXPECT_THAT(course.broken(), HasSubstr("calibrated before it is cleared"));
}

TEST(Latch, SeesAnUnplugThatDrivesAgainUnasked) {
  GoodCourse unlatched(&make_latch);
  unlatched.run(1, [](Observation& now) { now.servo.frame.state = OperatingState::Lost; });
  EXPECT_THAT(unlatched.broken(), HasSubstr("lost while it is driven"));
  for (const OperatingState state : {OperatingState::Inactive, OperatingState::Active}) {
    GoodCourse uncleared(&make_latch);
    uncleared.stop(OperatingState::Lost, FaultCode::Disconnected);
    uncleared.run(1);
    uncleared.run(1, [&](Observation& now) { now.servo.frame.state = state; });
    EXPECT_THAT(uncleared.broken(), HasSubstr("means Fault or Lost"));
  }
  GoodCourse other(&make_latch);
  other.stop(OperatingState::Calibrating, FaultCode::Estop);
  other.run(1);
  EXPECT_THAT(other.broken(), HasSubstr("means Fault or Lost")) << "of an unplug only";
}

TEST(Latch, SeesAnEstopThatStopsNothingAndARequestWithoutAnswer) {
  GoodCourse estop(&make_latch);
  estop.run(1, [](Observation& now) { now.is_estop_healthy = false; });
  EXPECT_THAT(estop.broken(), HasSubstr("e-stop"));
  GoodCourse asked(&make_latch);
  asked.run(1, [](Observation& now) { ++now.clear_asked; });
  EXPECT_THAT(asked.broken(), HasSubstr("answered"));
}

TEST(Latch, SeesAForceThatWasNotFinite) {
  GoodCourse course(&make_latch);
  course.stop(OperatingState::Fault, FaultCode::NonFiniteForce);
  course.run(1);
  EXPECT_THAT(course.broken(), HasSubstr("not finite"));
}

TEST(Recovery, HoldsOnAGoodCourse) { EXPECT_EQ(GoodCourse(&make_recovery).broken(), ""); }

void pause(GoodCourse& course) {
  course.run(1, [](Observation& now) {
    now.servo.frame.state = OperatingState::Inactive;
    now.servo.frame.gain = 0;
  });
}

TEST(Recovery, SeesAGainThatJumps) {
  GoodCourse course(&make_recovery);
  pause(course);
  course.run(1, [](Observation& now) { now.servo.frame.gain = 0.01; });
  EXPECT_THAT(course.broken(), HasSubstr("gain"));
}

TEST(Recovery, SeesAForceBeyondItsGain) {
  GoodCourse course(&make_recovery);
  pause(course);
  course.run(1, [](Observation& now) { now.servo.frame.force = {0.5, 0, 0}; });
  EXPECT_THAT(course.broken(), HasSubstr("beyond its gain"));
}

TEST(Recovery, AsksNothingOfAGhostThatLies) {
  for (const bool is_honest : {true, false}) {
    GoodCourse course([is_honest](Bounds bounds) {
      bounds.is_world_honest = is_honest;
      return make_recovery(bounds);
    });
    pause(course);
    course.run(1, [](Observation& now) { now.servo.frame.wish = {0, 90, 0}; });
    EXPECT_EQ(course.broken() == "", !is_honest);
  }
}

TEST(Recovery, SeesAGhostThatDoesNotStartAtTheHand) {
  const auto deep = [](Observation& now) { now.servo.frame.wish = {0, 1.5, 0}; };
  GoodCourse activated(&make_recovery);
  pause(activated);
  activated.run(1, deep);
  EXPECT_THAT(activated.broken(), HasSubstr("restart"));
  GoodCourse stale(&make_recovery);
  stale.run(5, [](Observation& now) { now.servo.frame.is_stale = true; });
  stale.run(1, [&](Observation& now) {
    now.servo.frame.is_stale = false;
    deep(now);
  });
  EXPECT_THAT(stale.broken(), HasSubstr("restart"));
}

}  // namespace
}  // namespace thimble::campaign
