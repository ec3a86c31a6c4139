#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "drivers/phantom/find_model.hpp"
#include "drivers/phantom/phantom_wire.hpp"

namespace thimble::phantom {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

TEST(PhantomModels, KnowsTheNamedModelsAndNoOther) {
  ASSERT_NE(find_model("phantom-vintage"), nullptr);
  ASSERT_NE(find_model("woody-2015"), nullptr);
  EXPECT_EQ(find_model("phantom-vintage")->name, "phantom-vintage");
  EXPECT_EQ(find_model(""), nullptr);
  EXPECT_EQ(find_model("phantom"), nullptr);
}

TEST(PhantomModels, VintageCarriesTheNumbersOfTheSheet) {
  const PhantomModel& sut = *find_model("phantom-vintage");
  EXPECT_EQ(sut.link_m, (std::array{0.056, 0.138, 0.112}));
  EXPECT_EQ(sut.capstan_diameter_m, (std::array{0.013, 0.010, 0.010}));
  EXPECT_EQ(sut.drum_diameter_m, (std::array{0.117, 0.077, 0.077}));
  EXPECT_EQ(sut.torque_constant_newton_m_per_a, (std::array{0.0163, 0.0163, 0.0163}));
  EXPECT_EQ(sut.counts_per_motor_rev, (std::array{4000.0, 4000.0, 4000.0}));
  EXPECT_EQ(sut.peak_force_newton, 5.0);
  EXPECT_EQ(sut.max_stiffness_newton_per_m, 800.0);
}

TEST(PhantomModels, VintageHomePoseIsTheOriginOfTheBaseFrame) {
  const PhantomModel& sut = *find_model("phantom-vintage");
  const double b = 45 * kDegree, c = 30 * kDegree;
  EXPECT_NEAR(sut.home_angle_rad[1], b, 1e-9);
  EXPECT_NEAR(sut.home_angle_rad[2], c, 1e-9);
  EXPECT_NEAR(sut.origin_m[0], 0.138 * std::sin(b) + 0.112 * std::sin(c), 1e-8);
  EXPECT_NEAR(sut.origin_m[2], 0.056 + 0.138 * std::cos(b) - 0.112 * std::cos(c), 1e-8);
}

// Upstream calibrates this build by setting the counters to 0, 0, 6000.
TEST(PhantomModels, WoodyHomePoseIsWhatItsCalibrationCountsSay) {
  const PhantomModel& sut = *find_model("woody-2015");
  const double angle_rad = 2 * std::numbers::pi * 6000 / sut.counts_per_motor_rev[2] *
                           sut.capstan_diameter_m[2] / sut.drum_diameter_m[2];
  EXPECT_NEAR(sut.home_angle_rad[2], sut.motor_direction[2] * angle_rad, 1e-8);
}

TEST(PhantomModels, PremiumCarriesTheNumbersOfTheSheet) {
  const PhantomModel& sut = *find_model("premium-1.5");
  EXPECT_EQ(sut.link_m[1], 0.20955);
  EXPECT_EQ(sut.link_m[2], 0.169545);
  const std::array<double, 3> ratio{13.3, 11.2, 11.2};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(sut.drum_diameter_m[i] / sut.capstan_diameter_m[i], ratio[i], 1e-12);
    EXPECT_EQ(sut.counts_per_motor_rev[i], 4 * 1024);
    EXPECT_EQ(sut.torque_constant_newton_m_per_a[i], 0.0234);
    EXPECT_LE(sut.continuous_current_a[i], 0.0286 / 0.0234) << "continuous torque of the motor";
    EXPECT_LE(sut.peak_current_a[i], 0.129 / 0.0234) << "stall";
  }
}

TEST(PhantomModels, AluhapticsAndPolhemCarryTheNumbersOfTheSheet) {
  const PhantomModel& aluhaptics = *find_model("aluhaptics-2");
  EXPECT_EQ(aluhaptics.link_m, (std::array{0.111, 0.140, 0.111}));
  EXPECT_EQ(aluhaptics.capstan_diameter_m, (std::array{0.0138, 0.0098, 0.0098}));
  EXPECT_EQ(aluhaptics.drum_diameter_m, (std::array{0.116, 0.076, 0.076}));
  EXPECT_EQ(aluhaptics.torque_constant_newton_m_per_a, (std::array{0.0259, 0.0259, 0.0259}));
  const PhantomModel& polhem = *find_model("polhem-1");
  EXPECT_EQ(polhem.link_m, (std::array{0.058, 0.174, 0.133}));
  EXPECT_EQ(polhem.capstan_diameter_m, (std::array{0.010, 0.010, 0.010}));
  EXPECT_EQ(polhem.drum_diameter_m, (std::array{0.180, 0.100, 0.100}));
  EXPECT_EQ(polhem.torque_constant_newton_m_per_a, (std::array{0.0538, 0.0538, 0.0538}));
  EXPECT_EQ(polhem.origin_m, (std::array{0.140, 0.0, 0.100}));
  for (const PhantomModel* sut : {&aluhaptics, &polhem}) {
    EXPECT_EQ(sut->counts_per_motor_rev, (std::array{2000.0, 2000.0, 2000.0}));
    EXPECT_EQ(sut->peak_force_newton, 5.0);
  }
  EXPECT_EQ(polhem.max_stiffness_newton_per_m, 800);
}

TEST(PhantomModels, OnlyPolhemHasAGimbal) {
  for (const PhantomModel& sut : kPhantomModels) {
    const double counts = sut.name == "polhem-1" ? 1024 : 0;
    EXPECT_EQ(sut.gimbal_counts_per_rev, (std::array{counts, counts, counts})) << sut.name;
  }
}

// What gimbal_angle_rad() relies on.
TEST(PhantomModels, AWholeNumberOfTurnsOfAnyGimbalFitsItsCounter) {
  for (const PhantomModel& sut : kPhantomModels) {
    for (const double counts : sut.gimbal_counts_per_rev) {
      if (counts == 0) continue;
      EXPECT_EQ(std::fmod(65536, counts), 0) << sut.name;
    }
  }
}

// Nobody has tried any of them: no arm is let push harder than those that are best known.
TEST(PhantomModels, NoModelPromisesMoreThanFiveNewton) {
  for (const PhantomModel& sut : kPhantomModels) EXPECT_LE(sut.peak_force_newton, 5.0) << sut.name;
}

TEST(PhantomModels, NoModelAsksForMoreThanTheLargestAmplifier) {
  for (const PhantomModel& sut : kPhantomModels) {
    for (std::size_t joint = 0; joint < 3; ++joint) {
      EXPECT_LE(sut.peak_current_a[joint], wire::kAmplifierLargeA) << sut.name;
      EXPECT_LE(sut.continuous_current_a[joint], sut.peak_current_a[joint]) << sut.name;
    }
    EXPECT_LE(sut.continuous_force_newton, sut.peak_force_newton) << sut.name;
  }
}

}  // namespace
}  // namespace thimble::phantom
