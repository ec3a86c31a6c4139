#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/model/arm/phantom_arm_model.hpp"
#include "tests/unit/sim/usb_frames.hpp"

namespace thimble::sim {
namespace {

constexpr plugin::SimModelSettings kThreeAmperes{.amplifier_max_a = 3, .seed = 0};

ArmParameters still_polhem() {
  ArmParameters p = polhem_1_parameters();
  p.balance = 1;
  p.backdrive_newton = 5;  // stands wherever it is put
  return p;
}

TEST(PhantomArmGimbal, ABoardWithAGimbalFoldsTheButtonIntoItsFirstCounter) {
  PhantomArmModel sut(still_polhem(), kThreeAmperes);
  EXPECT_EQ(sut.describe().vendor_id, 0x16c0);
  EXPECT_EQ(sut.describe().product_id, 0x0486);
  EXPECT_EQ(sut.describe().input_report_bytes, 64U);
  UsbFrames usb(sut);
  sut.move_tip_to(sut.home_position());
  usb.run_ms(3, set_counters(0, 0, 0));
  usb.run_ms(2, Fields{});  // the last set is handled a frame later
  sut.turn_stylus({0.5, -1.0, 3.0});
  const auto counts = [](double rad) {
    return static_cast<int>(std::floor(rad / (2 * std::numbers::pi) * 1024));
  };

  const Fields seen = usb.run_ms(3, Fields{});
  EXPECT_NEAR(seen[3], counts(0.5), 1);
  EXPECT_NEAR(seen[4], counts(-1.0), 1);
  EXPECT_NEAR(seen[5], counts(3.0), 1);

  sut.press_stylus_button(true);
  const Fields pressed = usb.run_ms(3, Fields{});
  EXPECT_EQ(pressed[3], seen[3] + 10'000);
  EXPECT_EQ(pressed[4], seen[4]);
  sut.press_stylus_button(false);
  EXPECT_EQ(usb.run_ms(3, Fields{}), seen);
  sut.turn_stylus({std::nan(""), 0, 0});
  EXPECT_EQ(usb.run_ms(3, Fields{}), seen);
}

TEST(PhantomArmGimbal, TheStylusKeepsItsDirectionWhileTheArmTurnsUnderIt) {
  PhantomArmModel sut(still_polhem(), kThreeAmperes);
  sut.move_tip_to(sut.home_position());
  for (const double angle_rad : sut.truth().gimbal_rad) EXPECT_NEAR(angle_rad, 0, 1e-9);

  ASSERT_TRUE(sut.move_tip_to({0.05, 0.03, 0}));

  const JointVector q = sut.plant().joint_rad();
  const JointVector home = polhem_1_parameters().home_rad;
  EXPECT_NEAR(sut.truth().gimbal_rad[0] + q[0], home[0], 1e-9);
  EXPECT_NEAR(sut.truth().gimbal_rad[1] + q[2], home[2], 1e-9);
  EXPECT_GT(std::abs(sut.truth().gimbal_rad[0]), 0.1);
  PhantomArmModel none(woody_2015_parameters(), kThreeAmperes);
  none.turn_stylus({1, 1, 1});
  EXPECT_EQ(none.truth().gimbal_rad, (std::array<double, 3>{}));
}

}  // namespace
}  // namespace thimble::sim
