#include "drivers/phantom/phantom_device.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "tests/unit/phantom/phantom_device_fixture.hpp"

namespace thimble::phantom {
namespace {

using std::chrono::milliseconds;

TEST_F(PhantomDeviceTest, SaysWhatItCanDo) {
  open(ReportForm::Mbed, 3);
  const HapticCapabilities& can = sut_->capabilities();
  EXPECT_EQ(can.model, "phantom-vintage");
  EXPECT_EQ(can.joint_count, 3U);
  EXPECT_EQ(can.peak_force_newton, 5);
  EXPECT_EQ(can.max_stiffness_newton_per_m, 800);
  EXPECT_EQ(can.peak_current_a, (std::array{3.0, 3.0, 3.0}));
  EXPECT_EQ(can.continuous_current_a, (std::array{1.75, 1.75, 1.75}));
  EXPECT_EQ(can.sample_period, milliseconds(1));
  EXPECT_EQ(can.device_watchdog, milliseconds(500));
  open(ReportForm::Mbed, 20);
  EXPECT_EQ(sut_->capabilities().peak_current_a, model_.peak_current_a);
  open(ReportForm::Mbed, 1);
  EXPECT_EQ(sut_->capabilities().continuous_current_a, (std::array{1.0, 1.0, 1.0}));
}

TEST_F(PhantomDeviceTest, SendsNothingByItselfUntilItIsClosed) {
  open();
  EXPECT_EQ(read(kRest), IoStatus::Ok);
  EXPECT_EQ(script_.submitted.size(), 0U);
  sut_.reset();
  ASSERT_EQ(script_.submitted.size(), 1U);
  EXPECT_EQ(script_.submitted.back(), std::vector<std::uint8_t>(14, 0));
}

TEST_F(PhantomDeviceTest, TellsItsGuardTheReportWithoutCurrent) {
  open();
  const auto zero = sut_->zero_command();
  ASSERT_TRUE(zero.has_value());
  EXPECT_EQ(zero->endpoint, 0);
  ASSERT_EQ(sut_->write(wrench(0, 0, 0)), IoStatus::Ok);
  EXPECT_EQ(std::vector<std::uint8_t>(zero->bytes.begin(), zero->bytes.end()),
            script_.submitted.back());
  EXPECT_EQ(script_.sent(wire::kCommand), wire::kCommandCurrents);
}

TEST_F(PhantomDeviceTest, TellsAPersonWhatToDo) {
  open();
  EXPECT_NE(sut_->calibration_instruction().find("first report"), std::string_view::npos);
  ASSERT_EQ(read(kRest), IoStatus::Ok);
  EXPECT_EQ(state_.calibration, CalibrationState::NeedsUser);
  EXPECT_NE(sut_->calibration_instruction().find("press the calibration button"),
            std::string_view::npos);
  calibrate();
  EXPECT_EQ(sut_->calibration_instruction(), "");
}

TEST_F(PhantomDeviceTest, ShowsTheHomePoseWhileItsCountersMeanNothing) {
  open();
  ASSERT_EQ(read({4000, -3000, 2000, 0, 0, 0, 0}), IoStatus::Ok);
  EXPECT_LT(norm(state_.tip - Position3{}), 1e-8);
  EXPECT_NEAR(state_.joint_position_rad[1], std::numbers::pi / 4, 1e-8);
}

TEST_F(PhantomDeviceTest, SendsAReportWithoutCurrentOnEveryWriteBeforeCalibration) {
  open();
  expect_no_current();
  ASSERT_EQ(read(kRest), IoStatus::Ok);
  expect_no_current();
  press();
  expect_no_current();
  EXPECT_EQ(script_.sent(wire::kCommand), wire::kCommandSetCounters);
  for (int i = 0; i < kSettleReports; ++i) {
    ASSERT_EQ(read(kRest), IoStatus::Ok);
    expect_no_current();
    EXPECT_EQ(script_.sent(wire::kCommand), wire::kCommandCurrents);
  }
  EXPECT_EQ(state_.calibration, CalibrationState::NeedsUser);
  ASSERT_EQ(read(kRest), IoStatus::Ok);
  EXPECT_EQ(state_.calibration, CalibrationState::Ok);
  ASSERT_EQ(sut_->write(wrench(1, 0, 0)), IoStatus::Ok);
  EXPECT_NE(script_.sent(wire::kCurrentA), 0);
}

TEST_F(PhantomDeviceTest, RepeatsALostCommandToZeroTheCounters) {
  open();
  ASSERT_EQ(read(kRest), IoStatus::Ok);
  press();
  for (int lost = 0; lost < 5; ++lost) {
    ASSERT_EQ(read(kPressed), IoStatus::Ok);
    expect_no_current();
    EXPECT_EQ(script_.sent(wire::kCommand), wire::kCommandSetCounters);
  }
}

TEST_F(PhantomDeviceTest, ReportsThePoseOfTheSheetsFormula) {
  open();
  calibrate();
  // Forearm: 1000 counts of 4000 are a quarter turn of its motor, over 10/77.
  ASSERT_EQ(read({0, 0, 1000, 0, 0, 0, 0}), IoStatus::Ok);
  const double c = model_.home_angle_rad[2] + std::numbers::pi / 2 * 10 / 77;
  const double b = model_.home_angle_rad[1];
  EXPECT_NEAR(state_.joint_position_rad[2], c, 1e-12);
  EXPECT_NEAR(state_.tip.x, 0, 1e-12);
  EXPECT_NEAR(state_.tip.y, 0.056 + 0.138 * std::cos(b) - 0.112 * std::cos(c) - model_.origin_m[2],
              1e-12);
  EXPECT_NEAR(state_.tip.z, 0.138 * std::sin(b) + 0.112 * std::sin(c) - model_.origin_m[0], 1e-12);
  EXPECT_EQ(state_.sampled_at, script_.now);
  EXPECT_EQ(state_.sample_sequence, script_.sequence);
}

TEST_F(PhantomDeviceTest, AJointBeyondItsStopsForgetsTheReference) {
  open();
  calibrate();
  int counts = 0;
  IoStatus status = IoStatus::Ok;
  while (status == IoStatus::Ok && counts < 40'000) {
    counts += 500;
    status = read({counts, 0, 0, 0, 0, 0, 0});
  }
  EXPECT_EQ(status, IoStatus::ProtocolError);
  EXPECT_EQ(sut_->counters().malformed, 1U);
  EXPECT_LT(state_.joint_position_rad[0], model_.joint_max_rad[0] + CounterTracker::kMargin_rad);
  EXPECT_GT(state_.joint_position_rad[0], model_.joint_max_rad[0]) << "no arm is refused early";
  expect_no_current();
  ASSERT_EQ(read({counts, 0, 0, 0, 0, 0, 0}), IoStatus::Ok);
  EXPECT_EQ(state_.calibration, CalibrationState::NeedsUser);
}

// A controller that was reset says nothing for the second that it takes to start.
TEST_F(PhantomDeviceTest, AGapShorterThanAResetKeepsTheReferenceWhereverTheArmWentMeanwhile) {
  open();
  calibrate();
  ASSERT_EQ(read({5000, -4000, 3000, 0, 0, 0, 0}, milliseconds(400)), IoStatus::Ok);
  EXPECT_EQ(state_.calibration, CalibrationState::Ok);
  const double ratio = 117.0 / 13;
  EXPECT_NEAR(state_.joint_position_rad[0], 2 * std::numbers::pi * 5000 / 4000 / ratio, 1e-9);
}

TEST_F(PhantomDeviceTest, TurnsAForceIntoMilliampere) {
  open();
  calibrate();
  ASSERT_EQ(read({300, -400, 500, 0, 0, 0, 0}), IoStatus::Ok);
  const Force3 force{0.3, -0.4, 0.5};
  ASSERT_EQ(sut_->write(wrench(force.x, force.y, force.z)), IoStatus::Ok);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(script_.sent(i), 1000 * current_a(i, force), 0.5);
    EXPECT_GT(std::abs(script_.sent(i)), 10);
  }
}

TEST_F(PhantomDeviceTest, HoldsEveryCurrentWithinTheAmplifierAndKeepsTheDirection) {
  open(ReportForm::Mbed, 3);
  calibrate();
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any_force(-500, 500);
  for (int round = 0; round < 500; ++round) {
    const Force3 force{any_force(random), any_force(random), any_force(random)};
    ASSERT_EQ(sut_->write(wrench(force.x, force.y, force.z)), IoStatus::Ok);
    const double scale = script_.sent(0) / current_a(0, force);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_LE(std::abs(script_.sent(i)), 3000);
      EXPECT_NEAR(script_.sent(i), scale * current_a(i, force),
                  1 + std::abs(current_a(i, force) / current_a(0, force)));
    }
  }
}

TEST_F(PhantomDeviceTest, SendsNoCurrentForAForceThatIsNoNumber) {
  open();
  calibrate();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const double huge = std::numeric_limits<double>::max();
  for (const double bad : {nan, infinity, -infinity}) {
    for (const Force3 force : {Force3{bad, 0, 0}, Force3{0, bad, 0}, Force3{1, 1, bad}}) {
      ASSERT_EQ(sut_->write(wrench(force.x, force.y, force.z)), IoStatus::Ok);
      EXPECT_EQ(script_.submitted.back(), std::vector<std::uint8_t>(14, 0));
    }
  }
  ASSERT_EQ(sut_->write(wrench(huge, huge, huge)), IoStatus::Ok);
  EXPECT_LE(std::abs(script_.sent(0)), 3000);
}

TEST_F(PhantomDeviceTest, AJumpOfTheCountersForgetsTheReferenceAndLeavesTheStateAlone) {
  open();
  calibrate();
  const HapticState before = state_;
  EXPECT_EQ(read({0, 0, 2000, 0, 0, 0, 0}), IoStatus::ProtocolError);
  EXPECT_EQ(state_.sample_sequence, before.sample_sequence);
  EXPECT_EQ(state_.tip, before.tip);
  EXPECT_EQ(sut_->counters().malformed, 1U);
  expect_no_current();
  EXPECT_EQ(read({0, 0, 2000, 0, 0, 0, 0}), IoStatus::Ok);
  EXPECT_EQ(state_.calibration, CalibrationState::NeedsUser);
  EXPECT_LT(norm(state_.tip - Position3{}), 1e-8);
}

TEST_F(PhantomDeviceTest, AResetControllerMustBeCalibratedAgain) {
  open();
  calibrate();
  for (int counts = 100; counts <= 900; counts += 100) {
    ASSERT_EQ(read({counts, counts, counts, 0, 0, 0, 0}), IoStatus::Ok);
  }
  EXPECT_EQ(read(kRest), IoStatus::ProtocolError);
  expect_no_current();
  EXPECT_EQ(read(kRest), IoStatus::Ok);
  EXPECT_EQ(state_.calibration, CalibrationState::NeedsUser);
}

TEST_F(PhantomDeviceTest, SilenceLongerThanTheWatchdogForgetsTheReference) {
  open();
  calibrate();
  ASSERT_EQ(read(kRest, milliseconds(500)), IoStatus::Ok);
  EXPECT_EQ(state_.calibration, CalibrationState::Ok);
  ASSERT_EQ(read(kRest, milliseconds(501)), IoStatus::Ok);
  EXPECT_EQ(state_.calibration, CalibrationState::NeedsUser);
  expect_no_current();
}

TEST_F(PhantomDeviceTest, RefusesReportsOfAnotherLengthAndKeepsItsReference) {
  open();
  calibrate();
  const HapticState before = state_;
  for (const std::size_t size : {0U, 13U, 15U, 64U}) {
    script_.arrive(kPressed, milliseconds(1), size);
    EXPECT_EQ(sut_->read(state_), IoStatus::ProtocolError);
  }
  EXPECT_EQ(state_.sample_sequence, before.sample_sequence);
  EXPECT_EQ(sut_->counters().malformed, 4U);
  ASSERT_EQ(read(kRest), IoStatus::Ok);
  EXPECT_EQ(state_.calibration, CalibrationState::Ok);
}

TEST_F(PhantomDeviceTest, NothingNewLeavesTheStateAlone) {
  open();
  calibrate();
  state_.tip = {7, 8, 9};
  EXPECT_EQ(sut_->read(state_), IoStatus::NoData);
  EXPECT_EQ(state_.tip, (Position3{7, 8, 9}));
}

TEST_F(PhantomDeviceTest, ALostBusSaysSoAndForgetsTheReference) {
  open();
  calibrate();
  script_.is_connected = false;
  EXPECT_EQ(sut_->read(state_), IoStatus::Disconnected);
  EXPECT_EQ(sut_->write(wrench(1, 1, 1)), IoStatus::Disconnected);
  EXPECT_NE(sut_->calibration_instruction(), "");
}

TEST_F(PhantomDeviceTest, ForgetsItsReferenceWhenAsked) {
  open();
  calibrate();
  sut_->forget_calibration();
  expect_no_current();
  // The flag is up from a press of before: lowered, not believed.
  ASSERT_EQ(read(kPressed), IoStatus::Ok);
  expect_no_current();
  for (int i = 0; i < 3 * kSettleReports; ++i) ASSERT_EQ(read(kRest), IoStatus::Ok);
  EXPECT_EQ(state_.calibration, CalibrationState::NeedsUser);
  calibrate();
}

TEST_F(PhantomDeviceTest, ReadsTheStylusButtonOfATeensy) {
  form_bytes_ = 64;
  open(ReportForm::Teensy);
  ASSERT_EQ(read({0, 0, 0, 10'030, 0, 0, 0}), IoStatus::Ok);
  EXPECT_EQ(state_.buttons, 1U);
  ASSERT_EQ(read({0, 0, 0, 30, 0, 0, 0}), IoStatus::Ok);
  EXPECT_EQ(state_.buttons, 0U);
  ASSERT_EQ(sut_->write(LimitedWrench::zero()), IoStatus::Ok);
  EXPECT_EQ(script_.submitted.back().size(), 64U);
}

TEST_F(PhantomDeviceTest, PassesOnWhatTheBusSaysAndCounts) {
  open();
  script_.submit_status = IoStatus::Backlogged;
  EXPECT_EQ(sut_->write(LimitedWrench::zero()), IoStatus::Backlogged);
  script_.counters = {
      .reports_in = 10, .reports_skipped = 2, .reports_out = 7, .writes_superseded = 3};
  const DeviceCounters counted = sut_->counters();
  EXPECT_EQ(counted.reports_in, 10U);
  EXPECT_EQ(counted.reports_skipped, 2U);
  EXPECT_EQ(counted.commands_out, 7U);
  EXPECT_EQ(counted.commands_superseded, 3U);
}

TEST_F(PhantomDeviceTest, NoReportsMakeItUnsafe) {
  open(ReportForm::Mbed, 3);
  std::mt19937 random(11);
  std::uniform_int_distribution<int> any_field(-32768, 32767), small(-300, 300), percent(0, 99);
  std::array<int, 7> field{};
  int calibrated = 0, malformed = 0;
  for (int round = 0; round < 300'000; ++round) {
    const bool is_wild = percent(random) == 0;
    for (std::size_t i = 0; i < 6; ++i) {
      field[i] = is_wild ? any_field(random) : field[i] + small(random) / 10;
    }
    if (percent(random) < 2) field[6] = field[6] == 0 ? 1 : 0;
    if (field[6] == 1 && percent(random) < 50) field = {0, 0, 0, 0, 0, 0, 0};
    const IoStatus status = read(field);
    malformed += status == IoStatus::ProtocolError ? 1 : 0;
    ASSERT_TRUE(is_finite(state_.tip));
    ASSERT_EQ(sut_->write(wrench(any_field(random), any_field(random), 3)), IoStatus::Ok);
    const bool is_calibrated = sut_->calibration_instruction().empty();
    calibrated += is_calibrated ? 1 : 0;
    for (std::size_t i = 0; i < 3; ++i) {
      ASSERT_LE(std::abs(script_.sent(i)), is_calibrated ? 3000 : 0);
    }
  }
  EXPECT_GT(calibrated, 1000);
  EXPECT_GT(malformed, 100);
}

}  // namespace
}  // namespace thimble::phantom
