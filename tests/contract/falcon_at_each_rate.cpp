#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "drivers/falcon/falcon_driver.hpp"
#include "drivers/falcon/firmware_image.hpp"
#include "sim/bus/sim_enumerator.hpp"
#include "sim/model/falcon/falcon_arm_model.hpp"
#include "tests/support/falcon_image.hpp"
#include "tests/support/open_limiter.hpp"
#include "tests/support/steady_grip.hpp"
#include "tests/support/temporary_folder.hpp"

// What a faster and a slower servo than usual see of the arm.
namespace thimble {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

class FalconAtEachRate : public testing::TestWithParam<Duration> {
 protected:
  void SetUp() override {
    auto model = std::make_unique<sim::FalconArmModel>(sim::falcon_parameters());
    arm_ = model.get();
    ASSERT_TRUE(buses_.plug(address_, std::move(model)));
    const std::vector<std::uint8_t> image = test::falcon_image();
    settings_.firmware =
        folder_.write("image", {reinterpret_cast<const char*>(image.data()), image.size()});
    settings_.firmware_sha256 = falcon::sha256_of(image);
    open();
    grip_.place = arm_->truth().tip;
    arm_->hold_tip(&grip_);
  }
  void open() {
    samples_ = 0;
    sut_.reset();
    auto device = falcon::make_falcon_driver()->open(buses_, buses_.list().at(0), settings_);
    ASSERT_TRUE(device) << device.error().message;
    sut_ = std::move(*device);
  }
  void TearDown() override { arm_->hold_tip(nullptr); }

  void run_for(Duration time) {
    for (Duration passed{}; passed < time; passed += GetParam()) {
      clock_.run_for(GetParam());
      if (sut_->read(state_) == IoStatus::Ok) ++samples_;
      static_cast<void>(sut_->write(test::wrench_for(force_, *sut_, state_)));
    }
  }
  bool runs_within(Duration time) {
    for (Duration passed{}; passed < time && samples_ == 0; passed += milliseconds(10)) {
      run_for(milliseconds(10));
    }
    return samples_ > 0;
  }
  void carry_to(Position3 place) {
    for (int step = 0; step < 200; ++step) {
      grip_.place = grip_.place + 0.04 * (place - grip_.place);
      run_for(milliseconds(2));
    }
    run_for(milliseconds(100));
  }
  // Pulls the grip fully out and pushes it in.
  void home() {
    carry_to({0, 0, 0.052});
    carry_to({0, 0, -0.03});
    ASSERT_EQ(state_.calibration, CalibrationState::Ok) << sut_->calibration_instruction();
    carry_to({0, 0, 0});
  }

  sim::VirtualClock clock_;
  sim::SimEnumerator buses_{clock_};
  bus::DeviceAddress address_{"sim:falcon"};
  testing_support::TemporaryFolder folder_;
  plugin::DriverSettings settings_;
  std::unique_ptr<HapticDevice> sut_;
  sim::FalconArmModel* arm_{nullptr};
  test::SteadyGrip grip_;
  HapticState state_;
  Force3 force_{};
  int samples_{0};
};

INSTANTIATE_TEST_SUITE_P(Ticks, FalconAtEachRate,
                         testing::Values(milliseconds(1), microseconds(250), milliseconds(2)));

TEST_P(FalconAtEachRate, UploadsItsFirmwareAndIsThere) {
  ASSERT_TRUE(runs_within(seconds(10))) << sut_->calibration_instruction();
  EXPECT_EQ(state_.calibration, CalibrationState::NeedsUser);
  EXPECT_EQ(sut_->counters().malformed, 0U);
}

TEST_P(FalconAtEachRate, SeesTheTipWhereItIsAndPushesWhereItIsAsked) {
  ASSERT_TRUE(runs_within(seconds(10)));
  home();
  for (const Position3 place : {Position3{0.02, 0.015, -0.02}, Position3{-0.03, -0.01, 0.01}}) {
    carry_to(place);
    EXPECT_LT(norm(state_.tip - arm_->truth().tip), 2e-4) << "encoder steps of three cranks";
    for (const Force3 force : {Force3{4, 0, 0}, Force3{0, 4, 0}, Force3{0, 0, 4}}) {
      force_ = force;
      run_for(milliseconds(100));
      const Force3 felt = arm_->truth().motor_force;
      // The scale is not known, so that the arm is weak; its direction is right all the same.
      EXPECT_LT(norm(felt), norm(force));
      EXPECT_GT(dot(felt, force) / (norm(felt) * norm(force)), 0.999);
      force_ = {};
      run_for(milliseconds(20));
      EXPECT_EQ(arm_->truth().motor_force, Force3{});
    }
  }
  EXPECT_EQ(sut_->counters().malformed, 0U);
}

// The latency timer lets a thousand through. A tick after an answer that just missed it costs
// another millisecond; a fast servo asks at once and falls into step with the timer.
TEST_P(FalconAtEachRate, SamplesComeAsOftenAsTheTicksLetThem) {
  arm_->load_firmware();
  ASSERT_TRUE(runs_within(milliseconds(200)));
  samples_ = 0;
  run_for(seconds(1));
  const int expected = GetParam() < milliseconds(1) ? 1000 : 500;
  EXPECT_NEAR(samples_, expected, 3);
}

TEST_P(FalconAtEachRate, TheButtonInTheMiddleIsTheStylusButton) {
  arm_->load_firmware();
  ASSERT_TRUE(runs_within(milliseconds(200)));
  run_for(milliseconds(20));
  EXPECT_EQ(state_.buttons, 0U);
  grip_.is_pressed = true;
  run_for(milliseconds(20));
  EXPECT_EQ(state_.buttons, 1U);
}

TEST_P(FalconAtEachRate, ShortAndGluedRepliesCostSamplesAndNoReference) {
  arm_->load_firmware();
  ASSERT_TRUE(runs_within(milliseconds(200)));
  home();
  arm_->set_faults({}, {.short_every = 20, .glue_every = 33});
  Duration longest{};
  for (int tick = 0; tick < 2000; ++tick) {
    run_for(GetParam());
    ASSERT_EQ(state_.calibration, CalibrationState::Ok);
    longest = std::max(longest, clock_.now() - state_.sampled_at);
  }
  EXPECT_LT(longest, milliseconds(20)) << "the servo would stop the arm";
  EXPECT_GT(sut_->counters().malformed, 10U);
  EXPECT_LT(norm(state_.tip - arm_->truth().tip), 2e-4);
}

TEST_P(FalconAtEachRate, AReturnedArmIsUploadedAndHomedAgain) {
  ASSERT_TRUE(runs_within(seconds(10)));
  home();
  ASSERT_TRUE(buses_.unplug(address_));
  clock_.run_for(milliseconds(10));
  EXPECT_EQ(sut_->read(state_), IoStatus::Disconnected);
  EXPECT_NE(sut_->calibration_instruction(), "");
  ASSERT_TRUE(buses_.replug(address_));
  open();
  ASSERT_TRUE(runs_within(seconds(10)));
  EXPECT_EQ(arm_->processor().counters().uploads, 2U);
  run_for(milliseconds(100));
  EXPECT_EQ(state_.calibration, CalibrationState::NeedsUser);
}

// Somebody else set the bridge back to what it has after power-up: the sample is as old as that.
TEST_P(FalconAtEachRate, ALatencyTimerOf16MsIsSeenInTheAgeOfSamples) {
  arm_->load_firmware();
  ASSERT_TRUE(runs_within(milliseconds(200)));
  ASSERT_EQ(arm_->control({.request = 9, .value = 16}, {}).handshake, plugin::UsbHandshake::Ack);
  run_for(milliseconds(100));
  samples_ = 0;
  Duration oldest{};
  for (int ms = 0; ms < 1000; ms += 2) {
    run_for(milliseconds(2));
    oldest = std::max(oldest, clock_.now() - state_.sampled_at);
  }
  EXPECT_GT(oldest, 3 * sut_->capabilities().sample_period) << "misses that the servo counts";
  EXPECT_GT(samples_, 50) << "and yet it goes on";
}

TEST_P(FalconAtEachRate, ClosedWhilePushingItIsLeftWithoutForce) {
  ASSERT_TRUE(runs_within(seconds(10)));
  home();
  force_ = {0, 0, 5};
  run_for(milliseconds(100));
  ASSERT_GT(norm(arm_->truth().motor_force), 0.1);
  // As the servo ends: zero for a few sample periods, then nothing.
  force_ = {};
  run_for(milliseconds(6));
  EXPECT_EQ(arm_->truth().motor_force, Force3{});
  sut_.reset();
  clock_.run_for(milliseconds(50));
  EXPECT_EQ(arm_->truth().motor_force, Force3{});
}

}  // namespace
}  // namespace thimble
