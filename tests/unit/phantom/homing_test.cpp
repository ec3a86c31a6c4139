#include "drivers/phantom/homing.hpp"

#include <gtest/gtest.h>

namespace thimble::phantom {
namespace {

using std::chrono::milliseconds;

class HomingTest : public testing::Test {
 protected:
  void report(bool is_pressed, std::int16_t counts = 0, int after_ms = 1) {
    DeviceReport report;
    report.is_calibration_pressed = is_pressed;
    report.base_counts = {counts, 0, static_cast<std::int16_t>(-counts)};
    sut.on_report(report, milliseconds(after_ms));
  }
  void press(std::int16_t counts = 0) {
    for (int i = 0; i < Homing::kPressReports; ++i) report(true, counts);
  }
  void settle(std::int16_t counts = 0) {
    for (int i = 0; i < 20; ++i) report(false, counts);
  }
  Homing sut;
};

TEST_F(HomingTest, KnowsNothingBeforeTheFirstReport) {
  EXPECT_EQ(sut.state(), CalibrationState::Unknown);
  EXPECT_FALSE(sut.wants_zero_counters());
}

TEST_F(HomingTest, WaitsForAPerson) {
  for (int i = 0; i < 1000; ++i) report(false);
  EXPECT_EQ(sut.state(), CalibrationState::NeedsUser);
  EXPECT_FALSE(sut.wants_zero_counters());
}

TEST_F(HomingTest, APressZeroesTheCountersAndThenHolds) {
  report(false);
  press(1234);
  EXPECT_TRUE(sut.wants_zero_counters());
  report(false);
  EXPECT_FALSE(sut.wants_zero_counters());
  EXPECT_EQ(sut.state(), CalibrationState::NeedsUser);
  settle();
  EXPECT_EQ(sut.state(), CalibrationState::Ok);
}

// Bytes gone wrong, however often, are no press: the controller keeps its flag up.
TEST_F(HomingTest, OnlyAFlagInSeveralReportsInARowIsAPress) {
  report(false);
  for (int i = 0; i < 1000; ++i) {
    report(i % Homing::kPressReports != 0);
    ASSERT_FALSE(sut.wants_zero_counters()) << i;
  }
  report(false);
  press();
  EXPECT_TRUE(sut.wants_zero_counters());
}

TEST_F(HomingTest, AnInterruptedPressBeginsAnewAfterForgetting) {
  report(false);
  for (int i = 1; i < Homing::kPressReports; ++i) report(true);
  sut.forget();
  report(false);
  report(true);
  EXPECT_FALSE(sut.wants_zero_counters());
}

TEST_F(HomingTest, RepeatsTheCommandUntilTheFlagIsDown) {
  report(false);
  press();
  for (int i = 0; i < 100; ++i) {
    report(true);
    EXPECT_TRUE(sut.wants_zero_counters());
  }
  EXPECT_EQ(sut.state(), CalibrationState::NeedsUser);
}

TEST_F(HomingTest, AFlagThatWasUpAtTheStartIsLoweredAndNotBelieved) {
  report(true);
  EXPECT_TRUE(sut.wants_zero_counters());
  report(true);
  report(false);
  settle();
  settle();
  EXPECT_EQ(sut.state(), CalibrationState::NeedsUser);
  press();
  report(false);
  settle();
  EXPECT_EQ(sut.state(), CalibrationState::Ok);
}

TEST_F(HomingTest, SettlesForItsTimeHoweverManyReportsThatTakes) {
  report(false);
  press();
  report(false);
  report(false, 0, 19);
  EXPECT_EQ(sut.state(), CalibrationState::NeedsUser);
  report(false, 0, 1);
  EXPECT_EQ(sut.state(), CalibrationState::Ok);
}

TEST_F(HomingTest, AButtonHeldDownIsZeroedAgainUntilItIsReleased) {
  report(false);
  press();
  report(false);
  for (int i = 0; i < 50; ++i) {
    report(true);
    EXPECT_TRUE(sut.wants_zero_counters());
    report(false);
  }
  EXPECT_EQ(sut.state(), CalibrationState::NeedsUser);
  settle();
  EXPECT_EQ(sut.state(), CalibrationState::Ok);
}

TEST_F(HomingTest, AnArmThatIsNotHeldStillHasNoReference) {
  report(false);
  press();
  report(false);
  settle(401);
  EXPECT_EQ(sut.state(), CalibrationState::NeedsUser);
  press();
  report(false);
  settle(-400);
  EXPECT_EQ(sut.state(), CalibrationState::Ok);
}

TEST_F(HomingTest, APressWhileCalibratedChangesNothingAndIsStaleAfterForgetting) {
  report(false);
  press();
  report(false);
  settle();
  report(true, 999);
  EXPECT_EQ(sut.state(), CalibrationState::Ok);
  EXPECT_FALSE(sut.wants_zero_counters());
  sut.forget();
  EXPECT_EQ(sut.state(), CalibrationState::Unknown);
  report(true, 999);
  report(false);
  settle();
  EXPECT_EQ(sut.state(), CalibrationState::NeedsUser);
}

}  // namespace
}  // namespace thimble::phantom
