#include <gtest/gtest.h>

#include <chrono>
#include <string>

#include "tests/scenario/at_each_rate.hpp"
#include "tests/support/closed_loop.hpp"

// The USB plug of an arm that has a supply of its own: its firmware goes on, and nothing on this
// computer reaches it. What its motors do then is its watchdog's to end, where it has one.
namespace thimble {
namespace {

using std::chrono::milliseconds;
using test::ClosedLoop;

class PulledCable : public test::AtEachRate {
 protected:
  // Pressing on a wall, its cable is pulled.
  void pull(const std::string& device) {
    sut_ = std::make_unique<ClosedLoop>(with({"arm.0.device=" + device, "arm.hand.motion=still"}));
    ASSERT_TRUE(sut_->run_until(10, [&] { return sut_->frame().gain == 1; }));
    sut_->sim_arm().backend().push_tip({4.5, 0, 0});
    sut_->run(0.6);
    ASSERT_TRUE(sut_->frame().is_in_contact);
    pressed_newton_ = motor_newton();
    ASSERT_GT(pressed_newton_, 0.1) << "a Falcon is weak while nobody has measured it";
    sut_->unplug(sim::Supply::Stays);
  }

  [[nodiscard]] double motor_newton() { return norm(sut_->truth().motor_force); }

  // What the motors may do, whatever pose the hand takes meanwhile.
  void see_no_more_than_the_limit() {
    EXPECT_LE(motor_newton(), 1.03 * sut_->settings().limiter.max_force_newton);
    EXPECT_EQ(norm(sut_->frame().force), 0);
  }

  // Not driven before it is calibrated and cleared, nor does a motor do anything.
  void run_until_resumed() {
    ASSERT_TRUE(sut_->run_until(8, [&] {
      EXPECT_EQ(motor_newton(), 0);
      return sut_->frame().state == OperatingState::Fault;
    })) << sut_->instruction();
    EXPECT_EQ(sut_->frame().calibration, CalibrationState::Ok);
    EXPECT_EQ(sut_->snapshot().fault.code, FaultCode::Disconnected);
    sut_->run(1, [&] { EXPECT_EQ(motor_newton(), 0); });
    sut_->controls().request_clear(sut_->snapshot().fault.number);
    ASSERT_TRUE(sut_->run_until(4, [&] { return sut_->frame().gain == 1; }));
    EXPECT_LT(norm(sut_->frame().tip - sut_->truth().tip), 1e-3);
  }

  std::unique_ptr<ClosedLoop> sut_;
  double pressed_newton_{0};
};
THIMBLE_AT_EACH_RATE(PulledCable);

TEST_P(PulledCable, OfAnArmWithAWatchdogEndsTheForceWhenThatSaysSo) {
  for (const auto& [device, watchdog] :
       {std::pair("sim:phantom-vintage", milliseconds(500)),
        std::pair("sim:woody-2015", milliseconds(500)),
        std::pair("sim:phantom-vintage-serial", milliseconds(100))}) {
    SCOPED_TRACE(device);
    pull(device);
    EXPECT_EQ(sut_->arm().session().device().capabilities().device_watchdog, watchdog);
    sut_->run(seconds(watchdog) - 0.02, [&] { see_no_more_than_the_limit(); });
    EXPECT_GT(motor_newton(), 0.5) << "its firmware has the last command, and nobody's next";
    sut_->run(0.03, [&] { see_no_more_than_the_limit(); });
    sut_->run(1, [&] { EXPECT_EQ(motor_newton(), 0); });
    EXPECT_FALSE(sut_->truth().is_amplifier_on);
    EXPECT_EQ(sut_->frame().state, OperatingState::Lost);

    sut_->sim_arm().backend().push_tip({});
    // Of one that speaks text a press is not seen where it is calibrated: it says so.
    if (device == std::string("sim:phantom-vintage-serial")) sut_->unplug();
    sut_->replug();
    run_until_resumed();
  }
}

// No source knows of a watchdog of a Falcon, so none is counted on. docs/first-arm.md says so.
TEST_P(PulledCable, OfAFalconTheLastForceStaysUntilItIsBackAndIsThenTheFirstThingToEnd) {
  pull("sim:falcon-loaded");
  sut_->run(5, [&] { see_no_more_than_the_limit(); });
  EXPECT_NEAR(motor_newton(), pressed_newton_, 0.3 * pressed_newton_);
  EXPECT_EQ(sut_->frame().state, OperatingState::Lost);

  sut_->replug();
  EXPECT_TRUE(sut_->run_until(0.1,
                              [&] {
                                see_no_more_than_the_limit();
                                return motor_newton() == 0;
                              }))
      << "still " << motor_newton() << " N";
  EXPECT_NE(sut_->frame().calibration, CalibrationState::Ok);
  sut_->sim_arm().backend().push_tip({});
  run_until_resumed();
}

}  // namespace
}  // namespace thimble
