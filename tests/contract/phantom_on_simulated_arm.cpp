#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>

#include "drivers/phantom/phantom_driver.hpp"
#include "sim/bus/sim_enumerator.hpp"
#include "sim/model/arm/register_arm_models.hpp"
#include "sim/model/arm/text_arm_model.hpp"
#include "tests/support/open_limiter.hpp"
#include "tests/support/steady_grip.hpp"

// Driver and simulated arm were written apart from the same sheet: bytes, signs, frames and
// units must come out the same at both ends.
namespace thimble {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

struct Setting {
  const char* model;
  Duration tick;
};

class PhantomOnSimulatedArm : public testing::TestWithParam<Setting> {
 protected:
  void SetUp() override {
    plugin::SimModelRegistry models;
    sim::register_arm_models(models);
    sim::register_text_arm_models(models);
    auto model = models.find(GetParam().model)->create({.amplifier_max_a = 6, .seed = 1});
    ASSERT_TRUE(model);
    ASSERT_TRUE(buses_.plug_any(address_, std::move(*model)));
    plugin::DriverSettings settings;
    settings.amplifier_max_a = 6.0;
    settings.clock = &clock_;
    auto device = phantom::make_phantom_driver()->open(buses_, buses_.list().at(0), settings);
    ASSERT_TRUE(device) << device.error().message;
    sut_ = std::move(*device);
    arm_ = buses_.arm_backend(address_);
    grip_.place = arm_->home_position();
    ASSERT_TRUE(arm_->move_tip_to(grip_.place));
    arm_->hold_tip(&grip_);
  }
  void TearDown() override { arm_->hold_tip(nullptr); }

  void run_for(Duration time) {
    for (Duration passed{}; passed < time; passed += GetParam().tick) {
      clock_.run_for(GetParam().tick);
      static_cast<void>(sut_->read(state_));
      static_cast<void>(sut_->write(
          test::wrench_for(force_, *sut_, state_)));  // Backlogged when ticks outrun frames
    }
  }
  void calibrate() {
    run_for(milliseconds(1500));  // the board boots
    ASSERT_EQ(state_.calibration, CalibrationState::NeedsUser);
    arm_->press_calibration_button(true);
    run_for(milliseconds(100));
    arm_->press_calibration_button(false);
    run_for(milliseconds(100));
    ASSERT_EQ(state_.calibration, CalibrationState::Ok);
  }
  void carry_to(Position3 place) {
    for (int step = 0; step < 400; ++step) {
      grip_.creep_to(place);
      run_for(milliseconds(1));
    }
    run_for(milliseconds(200));
  }

  sim::VirtualClock clock_;
  sim::SimEnumerator buses_{clock_};
  bus::DeviceAddress address_{std::string("sim:") + GetParam().model};
  std::unique_ptr<HapticDevice> sut_;
  plugin::ArmBackend* arm_{nullptr};
  test::SteadyGrip grip_;
  HapticState state_;
  Force3 force_{};
};

INSTANTIATE_TEST_SUITE_P(Arms, PhantomOnSimulatedArm,
                         testing::Values(Setting{"phantom-vintage", milliseconds(1)},
                                         Setting{"phantom-vintage", microseconds(125)},
                                         Setting{"woody-2015", milliseconds(2)},
                                         Setting{"premium-1.5", milliseconds(1)},
                                         Setting{"aluhaptics-2", microseconds(500)},
                                         Setting{"polhem-1", milliseconds(1)},
                                         Setting{"phantom-vintage-serial", milliseconds(1)},
                                         Setting{"premium-1.5-serial", milliseconds(2)},
                                         Setting{"woody-2015-serial", microseconds(250)}));

TEST_P(PhantomOnSimulatedArm, SeesTheTipWhereItIsAndPushesAsAsked) {
  calibrate();
  for (const Position3 place : {Position3{0.03, 0.02, -0.04}, Position3{-0.04, -0.04, 0.04}}) {
    carry_to(place);
    EXPECT_LT(norm(state_.tip - arm_->truth().tip), 3e-4) << "encoder steps at three joints";
    for (const Force3 force : {Force3{1, 0, 0}, Force3{0, 1, 0}, Force3{0, 0, 1}}) {
      force_ = force;
      run_for(milliseconds(200));
      EXPECT_LT(norm(arm_->truth().motor_force - force), 0.02);
      force_ = {};
      run_for(milliseconds(20));
    }
  }
  EXPECT_EQ(sut_->counters().malformed, 0U);
}

TEST_P(PhantomOnSimulatedArm, SeesTheGimbalAsItIsHeldWhereThereIsOne) {
  calibrate();
  const bool has_gimbal = sut_->capabilities().joint_count == kMaxJoints;
  EXPECT_EQ(has_gimbal, std::string(GetParam().model) == "polhem-1");
  for (const double turned_rad : {0.0, 1.2, -2.9, 40.0}) {
    // Five turns of the first axis would read as its button: the wire has no room for more.
    arm_->turn_stylus({std::min(turned_rad, 30.0), -turned_rad, 0.5 * turned_rad});
    arm_->press_stylus_button(turned_rad < 0);
    run_for(milliseconds(10));
    const std::array<double, 3> held_rad = arm_->truth().gimbal_rad;
    for (std::size_t i = 0; i < 3; ++i) {
      const double seen_rad = state_.joint_position_rad[kFirstGimbalJoint + i];
      EXPECT_NEAR(std::remainder(seen_rad - held_rad[i], 2 * std::numbers::pi), 0, 0.0125)
          << "two steps of its encoder";
    }
    EXPECT_EQ(state_.buttons, has_gimbal && turned_rad < 0 ? 1U : 0U);
  }
  EXPECT_EQ(state_.calibration, CalibrationState::Ok);
}

TEST_P(PhantomOnSimulatedArm, MovesNoMotorBeforeCalibration) {
  force_ = {1, 1, 1};
  for (int i = 0; i < 100; ++i) {
    run_for(milliseconds(20));
    ASSERT_EQ(arm_->truth().motor_current_a, (std::array{0.0, 0.0, 0.0}));
  }
}

TEST_P(PhantomOnSimulatedArm, AReturnedArmMustBeCalibratedAgain) {
  calibrate();
  ASSERT_TRUE(buses_.unplug(address_));
  clock_.run_for(milliseconds(10));
  EXPECT_EQ(sut_->read(state_), IoStatus::Disconnected);
  EXPECT_NE(sut_->calibration_instruction(), "");
}

}  // namespace
}  // namespace thimble
