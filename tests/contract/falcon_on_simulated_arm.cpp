#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/falcon/falcon_driver.hpp"
#include "drivers/falcon/firmware_image.hpp"
#include "sim/bus/sim_enumerator.hpp"
#include "sim/model/falcon/falcon_arm_model.hpp"
#include "tests/support/falcon_image.hpp"
#include "tests/support/open_limiter.hpp"
#include "tests/support/steady_grip.hpp"
#include "tests/support/temporary_folder.hpp"

// Driver and simulated arm were written apart from the same sheet: bytes, their order, signs,
// frames and units must come out the same at both ends.
namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// What the model's motors are worth, as a kitchen scale would have told.
constexpr double kTrueNewtonPerCount = 10.0 / 4095;

class FalconOnSimulatedArm : public testing::Test {
 protected:
  explicit FalconOnSimulatedArm(
      const sim::FalconParameters& parameters = sim::falcon_parameters()) {
    auto model = std::make_unique<sim::FalconArmModel>(parameters);
    arm_ = model.get();
    EXPECT_TRUE(buses_.plug(address_, std::move(model)));
    grip_.place = arm_->calibration_start();
    arm_->hold_tip(&grip_);
  }
  ~FalconOnSimulatedArm() override { arm_->hold_tip(nullptr); }

  void open(bool has_image = true, std::optional<double> newton_per_count = kTrueNewtonPerCount) {
    plugin::DriverSettings settings;
    settings.newton_per_count = newton_per_count;
    if (has_image) {
      const std::vector<std::uint8_t> image = test::falcon_image();
      settings.firmware =
          folder_.write("image", {reinterpret_cast<const char*>(image.data()), image.size()});
      settings.firmware_sha256 = falcon::sha256_of(image);
    }
    auto device = falcon::make_falcon_driver()->open(buses_, buses_.list().at(0), settings);
    ASSERT_TRUE(device) << device.error().message;
    sut_ = std::move(*device);
  }
  void run_for(Duration time) {
    for (Duration passed{}; passed < time; passed += milliseconds(1)) {
      clock_.run_for(milliseconds(1));
      if (sut_->read(state_) == IoStatus::Ok) ++samples_;
      static_cast<void>(sut_->write(test::wrench_for(force_, *sut_, state_)));
    }
  }
  // False: not within `time`.
  bool run_until(CalibrationState state, Duration time) {
    for (Duration passed{}; passed < time; passed += milliseconds(1)) {
      if (state_.calibration == state) return true;
      run_for(milliseconds(1));
    }
    return false;
  }
  void carry_to(Position3 place) {
    for (int step = 0; step < 400; ++step) {
      grip_.creep_to(place);
      run_for(milliseconds(1));
    }
    run_for(milliseconds(200));
  }
  void calibrate() {
    ASSERT_TRUE(run_until(CalibrationState::NeedsUser, seconds(20)));
    carry_to(arm_->calibration_start());
    carry_to(arm_->home_position());
    ASSERT_EQ(state_.calibration, CalibrationState::Ok);
  }
  Force3 felt(Force3 asked) {
    force_ = asked;
    run_for(milliseconds(200));
    const Force3 felt = arm_->truth().motor_force;
    force_ = {};
    run_for(milliseconds(20));
    return felt;
  }

  sim::VirtualClock clock_;
  sim::SimEnumerator buses_{clock_};
  bus::DeviceAddress address_{"sim:falcon"};
  testing_support::TemporaryFolder folder_;
  sim::FalconArmModel* arm_{nullptr};
  std::unique_ptr<HapticDevice> sut_;
  test::SteadyGrip grip_;
  HapticState state_;
  Force3 force_{};
  int samples_{0};
};

TEST_F(FalconOnSimulatedArm, UploadsHomesSeesTheGripWhereItIsAndPushesAsAsked) {
  open();
  calibrate();
  EXPECT_EQ(arm_->processor().counters().uploads, 1U);
  for (const Position3 place : {Position3{0.03, 0.02, -0.02}, Position3{-0.02, -0.02, 0.03}}) {
    carry_to(place);
    EXPECT_LT(norm(state_.tip - arm_->truth().tip), 3e-4) << "encoder steps at three cranks";
    for (const Force3 asked : {Force3{1, 0, 0}, Force3{0, 1, 0}, Force3{0, 0, 1}}) {
      EXPECT_LT(norm(felt(asked) - asked), 0.03);
    }
  }
  EXPECT_EQ(sut_->counters().malformed, 0U);
  EXPECT_EQ(arm_->processor().firmware().counters().broken, 0U);
  EXPECT_EQ(arm_->processor().firmware().counters().forces_before_homed, 0U);
}

TEST_F(FalconOnSimulatedArm, FirmwareThatRunsAlreadyNeedsNoImage) {
  arm_->load_firmware();
  open(false);
  calibrate();
  EXPECT_EQ(arm_->processor().counters().uploads, 0U);
}

TEST_F(FalconOnSimulatedArm, WithoutAnImageAnEmptyArmIsNeverDriven) {
  open(false);
  EXPECT_FALSE(run_until(CalibrationState::NeedsUser, seconds(10)));
  EXPECT_NE(sut_->calibration_instruction(), "");
}

TEST_F(FalconOnSimulatedArm, MovesNoMotorBeforeItIsHomed) {
  open();
  force_ = {1, 1, 1};
  for (int i = 0; i < 400; ++i) {
    run_for(milliseconds(20));
    ASSERT_EQ(arm_->truth().motor_force, Force3{});
  }
  EXPECT_EQ(state_.calibration, CalibrationState::NeedsUser);
}

TEST_F(FalconOnSimulatedArm, ALostEchoAndUnansweredQuestionsCostTimeOnly) {
  arm_->set_faults({.lost_echo = 4000, .deaf_questions = 7}, {});
  open();
  calibrate();
  EXPECT_EQ(arm_->processor().counters().uploads, 2U);
}

TEST_F(FalconOnSimulatedArm, ShortAndGluedRepliesCostSamplesOnly) {
  open();
  calibrate();
  arm_->set_faults({}, {.short_every = 7, .glue_every = 5});
  samples_ = 0;
  for (const Position3 place : {Position3{0.02, 0, 0}, Position3{0, -0.02, -0.02}}) {
    carry_to(place);
    EXPECT_LT(norm(state_.tip - arm_->truth().tip), 5e-4);
    EXPECT_LT(norm(felt({0, 1, 0}) - Force3{0, 1, 0}), 0.1);
  }
  EXPECT_EQ(state_.calibration, CalibrationState::Ok);
  EXPECT_GT(samples_, 200);
}

TEST_F(FalconOnSimulatedArm, AnUnmeasuredArmIsWeak) {
  open(true, std::nullopt);
  calibrate();
  const Force3 force = felt({0, 0, 2});
  EXPECT_GT(force.z, 0.05);
  EXPECT_LT(force.z, 2);
}

TEST_F(FalconOnSimulatedArm, APowerCutTakesFirmwareAndReference) {
  open();
  calibrate();
  force_ = {0, 0, 1};
  run_for(milliseconds(100));
  arm_->power_cycle();
  EXPECT_EQ(arm_->truth().motor_force, Force3{});
  for (int i = 0; i < 500; ++i) {
    run_for(milliseconds(20));
    ASSERT_EQ(arm_->truth().motor_force, Force3{}) << "not homed again";
  }
  EXPECT_NE(state_.calibration, CalibrationState::Ok);
  force_ = {};
  calibrate();
  EXPECT_EQ(arm_->processor().counters().uploads, 2U);
}

TEST_F(FalconOnSimulatedArm, AnUnpluggedArmIsGone) {
  open();
  calibrate();
  ASSERT_TRUE(buses_.unplug(address_));
  clock_.run_for(milliseconds(10));
  EXPECT_EQ(sut_->read(state_), IoStatus::Disconnected);
}

sim::FalconParameters stronger() {
  sim::FalconParameters parameters = sim::falcon_parameters();
  parameters.newton_per_count *= 1.3;
  return parameters;
}

class FalconOnAStrongerArm : public FalconOnSimulatedArm {
 protected:
  FalconOnAStrongerArm() : FalconOnSimulatedArm(stronger()) {}
};

TEST_F(FalconOnAStrongerArm, PushesAsMuchMoreUntilItsScaleIsSaid) {
  open();
  calibrate();
  EXPECT_NEAR(felt({0, 0, 2}).z, 2.6, 0.05);
  sut_.reset();
  open(true, 1.3 * kTrueNewtonPerCount);
  state_ = {};
  calibrate();
  EXPECT_NEAR(felt({0, 0, 2}).z, 2, 0.05);
}

}  // namespace
}  // namespace thimble
