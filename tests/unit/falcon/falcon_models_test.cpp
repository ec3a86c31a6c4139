#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "drivers/falcon/falcon_wire.hpp"
#include "drivers/falcon/find_model.hpp"

namespace thimble::falcon {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

const FalconModel& falcon() { return *find_model("falcon"); }

TEST(FalconModels, KnowsTheNamedModelAndNoOther) {
  ASSERT_NE(find_model("falcon"), nullptr);
  EXPECT_EQ(find_model("falcon")->name, "falcon");
  EXPECT_EQ(find_model(""), nullptr);
  EXPECT_EQ(find_model("falcon-2"), nullptr);
}

TEST(FalconModels, CarriesTheNumbersOfTheSheet) {
  EXPECT_EQ(falcon().crank_m, 0.060);
  EXPECT_EQ(falcon().rods_m, 0.1025);
  EXPECT_EQ(falcon().grip_radius_m, 0.01443);
  EXPECT_EQ(falcon().knee_m, 0.01125);
  EXPECT_EQ(falcon().ankle_m, 0.01125);
  EXPECT_EQ(falcon().grip_shift_m, -0.025);
  EXPECT_EQ(falcon().base_radius_m, 0.0400);
  EXPECT_EQ(falcon().base_shift_m, -0.02309);
  const std::array<double, 3> azimuth_degrees{90 + 15, -30 + 15, -150 + 15};
  for (std::size_t leg = 0; leg < 3; ++leg) {
    EXPECT_NEAR(falcon().leg_azimuth_rad[leg], azimuth_degrees[leg] * kDegree, 1e-9);
    EXPECT_EQ(falcon().motor_direction[leg], -1);
  }
  EXPECT_NEAR(falcon().home_angle_rad, 35 * kDegree, 1e-9);
}

// The sheet's 1.7 derives these from the wheel and the two diameters.
TEST(FalconModels, TurnsOfTheMotorAndOfTheCrankAreThoseOfTheSheet) {
  const double ratio = falcon().drum_diameter_m / falcon().capstan_diameter_m;
  EXPECT_NEAR(ratio, 7.719, 0.001);
  const double counts_per_turn = falcon().counts_per_motor_rev * ratio;
  EXPECT_NEAR(counts_per_turn, 9881, 1);
  EXPECT_NEAR(360 / counts_per_turn, 0.03643, 0.00001);
  EXPECT_NEAR(2 * std::numbers::pi / counts_per_turn * falcon().crank_m, 0.038e-3, 0.001e-3);
}

TEST(FalconModels, EncodersCannotBeTakenForTheirWraps) {
  const double counts_per_rad = falcon().counts_per_motor_rev * falcon().drum_diameter_m /
                                falcon().capstan_diameter_m / (2 * std::numbers::pi);
  for (std::size_t leg = 0; leg < 3; ++leg) {
    const double way_rad = falcon().crank_max_rad[leg] - falcon().crank_min_rad[leg];
    EXPECT_LT(way_rad * counts_per_rad, 32768);
    EXPECT_GT(falcon().home_angle_rad, falcon().crank_min_rad[leg]);
    EXPECT_LT(falcon().home_angle_rad, falcon().crank_max_rad[leg]);
  }
}

// 57 counts to a vendor's unit; the unit taken for a newton.
TEST(FalconModels, AScaleThatNobodyKnowsIsTheOneOfTheWeakerArm) {
  const double by_samples = 25.0 / ((1311 + 1453 + 1526) / 3.0);
  const double by_advertisement = 8.9 / wire::kMaxMotor_counts;
  EXPECT_NEAR(falcon().newton_per_count, by_samples, 0.001);
  EXPECT_GT(falcon().newton_per_count, 5 * by_advertisement);
}

TEST(FalconModels, PromisesNoMoreThanIsAdvertised) {
  EXPECT_LE(falcon().peak_force_newton, 8.9);
  EXPECT_LE(falcon().continuous_force_newton, falcon().peak_force_newton);
  EXPECT_LE(falcon().continuous_share, 1);
  EXPECT_LE(falcon().workspace_radius_m, 2 * 0.0254);
  EXPECT_LE(falcon().max_stiffness_newton_per_m, 3000);
}

}  // namespace
}  // namespace thimble::falcon
