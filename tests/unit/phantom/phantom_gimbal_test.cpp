#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/unit/phantom/phantom_device_fixture.hpp"

namespace thimble::phantom {
namespace {

// An arm with a gimbal, behind the board that folds its button into the first of the counters.
class PhantomGimbalTest : public PhantomDeviceTest {
 protected:
  PhantomGimbalTest() : PhantomDeviceTest("polhem-1") {
    form_bytes_ = 64;
    open(ReportForm::Teensy);
  }
  [[nodiscard]] double gimbal_rad(std::size_t axis) const {
    return state_.joint_position_rad[kFirstGimbalJoint + axis];
  }
};

TEST_F(PhantomGimbalTest, AnglesComeBackFromTheWireWithTheButtonPressedOrNot) {
  EXPECT_EQ(sut_->capabilities().joint_count, 6U);
  calibrate();
  std::mt19937 random(7);
  std::uniform_real_distribution<double> angle(-std::numbers::pi, std::numbers::pi);
  for (int round = 0; round < 2000; ++round) {
    const std::array<double, 3> held_rad{angle(random), angle(random), angle(random)};
    const bool is_pressed = round % 3 == 0;
    std::array<int, 7> field{};
    for (std::size_t i = 0; i < 3; ++i) {
      field[3 + i] = static_cast<int>(std::floor(held_rad[i] / (2 * std::numbers::pi) * 1024));
    }
    if (is_pressed) field[3] += wire::kButtonFold;
    ASSERT_EQ(read(field), IoStatus::Ok);
    for (std::size_t i = 0; i < 3; ++i) {
      ASSERT_NEAR(gimbal_rad(i), held_rad[i], 2 * std::numbers::pi / 1024 + 1e-12);
    }
    ASSERT_EQ(state_.buttons, is_pressed ? 1U : 0U);
    ASSERT_EQ(state_.calibration, CalibrationState::Ok)
        << "a gimbal is no reason to doubt the base";
  }
}

TEST_F(PhantomGimbalTest, AnglesAreZeroWhileTheCountersMeanNothing) {
  ASSERT_EQ(read({0, 0, 0, 300, -200, 100, 0}), IoStatus::Ok);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(gimbal_rad(i), 0);
  calibrate();
  ASSERT_EQ(read({0, 0, 0, 300, -200, 100, 0}), IoStatus::Ok);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NE(gimbal_rad(i), 0);
  sut_->forget_calibration();
  ASSERT_EQ(read({0, 0, 0, 300, -200, 100, 0}), IoStatus::Ok);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(gimbal_rad(i), 0);
}

TEST_F(PhantomDeviceTest, WithoutAGimbalItsCountersAreNoAngles) {
  open();
  calibrate();
  ASSERT_EQ(read({0, 0, 0, 300, -200, 100, 0}), IoStatus::Ok);
  EXPECT_EQ(sut_->capabilities().joint_count, 3U);
  for (std::size_t i = kFirstGimbalJoint; i < kMaxJoints; ++i) {
    EXPECT_EQ(state_.joint_position_rad[i], 0);
  }
}

}  // namespace
}  // namespace thimble::phantom
