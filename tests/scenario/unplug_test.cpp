#include <gtest/gtest.h>

#include <chrono>

#include "tests/scenario/at_each_rate.hpp"
#include "tests/support/arm_watch.hpp"

namespace thimble {
namespace {

using test::ArmWatch;
using test::ClosedLoop;

const std::vector<std::string> kStill{"arm.hand.motion=still"};

class Unplug : public test::AtEachRate {
 protected:
  // Its person has calibrated it, and it waits for a clear.
  static void run_until_calibrated(ClosedLoop& loop, ArmWatch& watch) {
    ASSERT_TRUE(loop.run_until(8,
                               [&] {
                                 watch.see();
                                 EXPECT_EQ(norm(loop.frame().force), 0);
                                 return loop.frame().state == OperatingState::Fault;
                               }))
        << "state " << to_string(loop.frame().state) << ": " << loop.instruction();
    EXPECT_EQ(loop.frame().calibration, CalibrationState::Ok);
    EXPECT_EQ(loop.snapshot().fault.code, FaultCode::Disconnected);
  }
  static void clear(ClosedLoop& loop) {
    loop.controls().request_clear(loop.snapshot().fault.number);
  }
  static void run_until_active(ClosedLoop& loop, ArmWatch& watch) {
    ASSERT_TRUE(loop.run_until(4,
                               [&] {
                                 watch.see();
                                 const servo::ServoFrame& frame = loop.frame();
                                 if (frame.calibration != CalibrationState::Ok) {
                                   EXPECT_EQ(norm(frame.force), 0);
                                   EXPECT_NE(frame.state, OperatingState::Active);
                                 }
                                 return frame.state == OperatingState::Active;
                               }))
        << "state " << to_string(loop.frame().state);
  }
};
THIMBLE_AT_EACH_RATE(Unplug);

TEST_P(Unplug, WhileTheWallPressesTheMotorsStopAndTheStopIsRecorded) {
  ClosedLoop sut(with(kStill));
  sut.run_until_leaning();
  ArmWatch watch(sut);
  sut.unplug();
  sut.tick();
  EXPECT_EQ(sut.frame().state, OperatingState::Lost);
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::Disconnected);
  EXPECT_EQ(norm(sut.frame().force), 0);
  sut.run(0.005);
  EXPECT_EQ(norm(sut.truth().motor_force), 0) << "no power";
  EXPECT_FALSE(sut.truth().is_amplifier_on);
  sut.run(1, [&] {
    watch.see();
    EXPECT_EQ(sut.frame().state, OperatingState::Lost);
  });
  EXPECT_EQ(watch.breach(), "");
  const std::optional<session::Recording> recording = sut.arm().session().take_recording();
  ASSERT_TRUE(recording.has_value());
  EXPECT_EQ(recording->header.fault.code, FaultCode::Disconnected);
  EXPECT_EQ(recording->header.fault.number, sut.snapshot().fault.number);
  EXPECT_EQ(recording->frames.back().fault, FaultCode::Disconnected);
}

TEST_P(Unplug, AReturnedArmIsCalibratedThenClearedAndDrivenFromZeroWithoutAJump) {
  ClosedLoop sut(with(kStill));
  sut.run_until_leaning();
  ArmWatch watch(sut);
  sut.unplug();
  sut.run(0.3, [&] { watch.see(); });
  sut.sim_arm().backend().push_tip({});
  sut.replug();
  sut.run(0.5, [&] {
    watch.see();
    EXPECT_NE(sut.frame().state, OperatingState::Active);
    EXPECT_NE(sut.instruction(), "");
  });
  run_until_calibrated(sut, watch);
  clear(sut);
  run_until_active(sut, watch);
  EXPECT_EQ(sut.instruction(), "");
  EXPECT_LT(sut.frame().gain, 0.01);
  EXPECT_EQ(norm(sut.frame().offset), 0);
  EXPECT_LT(norm(sut.frame().tip - sut.truth().tip), 0.5e-3) << "the new reference is right";
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::None);

  sut.run(1, [&] { watch.see(); });
  sut.sim_arm().backend().push_tip({4.5, 0, 0});
  sut.run(0.6, [&] { watch.see(); });
  EXPECT_TRUE(sut.frame().is_in_contact);
  EXPECT_GT(norm(sut.truth().motor_force), 1) << "and the wall is where it was";
  EXPECT_EQ(watch.breach(), "");
}

TEST_P(Unplug, ACableThatIsBackBeforeTheNextTickLosesTheArmAllTheSame) {
  ClosedLoop sut(with(kStill));
  sut.run_until_leaning();
  ArmWatch watch(sut);
  sut.unplug();
  sut.replug();
  sut.sim_arm().backend().push_tip({});
  sut.tick();
  watch.see();
  EXPECT_NE(sut.frame().state, OperatingState::Active);
  EXPECT_EQ(norm(sut.frame().force), 0);
  run_until_calibrated(sut, watch);
  clear(sut);
  run_until_active(sut, watch);
  sut.run(0.6, [&] { watch.see(); });
  EXPECT_LT(norm(sut.frame().tip - sut.truth().tip), 0.5e-3);
  EXPECT_EQ(watch.breach(), "");
}

TEST_P(Unplug, AtAnyMomentOfTheCalibrationNothingMovesBeforeItIsDone) {
  ClosedLoop sut(with({"arm.hand.motion=explore"}));
  ArmWatch watch(sut);
  for (const double s : {0.1, 0.57, 0.62, 1.3}) {
    sut.run(s, [&] { watch.see(); });
    sut.unplug();
    sut.run(0.05, [&] { watch.see(); });
    sut.replug();
  }
  run_until_active(sut, watch);
  sut.run(2, [&] { watch.see(); });
  EXPECT_LT(norm(sut.frame().tip - sut.truth().tip), 1e-3);
  EXPECT_EQ(watch.breach(), "");
}

TEST_P(Unplug, AFaultThatLatchedBeforeOutlivesTheReturn) {
  ClosedLoop sut(with(kStill));
  sut.run_until_leaning();
  ArmWatch watch(sut);
  sut.controls().is_estop_healthy = false;
  sut.tick();
  sut.controls().is_estop_healthy = true;
  sut.sim_arm().backend().push_tip({});
  sut.unplug();
  sut.run(0.1, [&] { watch.see(); });
  EXPECT_EQ(sut.frame().state, OperatingState::Lost);
  sut.replug();
  sut.run(4, [&] { watch.see(); });
  EXPECT_EQ(sut.frame().state, OperatingState::Fault);
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::Estop);
  sut.controls().request_clear(sut.snapshot().fault.number);
  run_until_active(sut, watch);
  EXPECT_EQ(watch.breach(), "");
}

}  // namespace
}  // namespace thimble
