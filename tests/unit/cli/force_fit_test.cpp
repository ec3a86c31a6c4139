#include "cli/force_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace thimble::cli {
namespace {

std::vector<ScaleReading> readings_of(double slope, double rest_gram) {
  std::vector<ScaleReading> readings;
  for (const double newton : even_forces_newton(5, 6)) {
    readings.push_back({newton, std::round(slope * newton / 9.80665e-3 + rest_gram)});
  }
  return readings;
}

TEST(ForceFit, FindsTheSlopeWhateverTheArmWeighs) {
  for (const double slope : {0.14, 0.7, 1.0, 1.3, 4.0}) {
    for (const double rest_gram : {-300.0, 0.0, 250.0}) {
      const auto sut = fit_force(readings_of(slope, rest_gram), 0.0175);
      ASSERT_TRUE(sut) << slope << " " << sut.error().message;
      EXPECT_NEAR(sut->newton_per_count, 0.0175 * slope, 0.0175 * slope * 0.02);
      EXPECT_NEAR(sut->rest_gram, rest_gram, 1.5);
    }
  }
}

TEST(ForceFit, RefusesWhatCannotBeAScaleUnderAnArm) {
  EXPECT_FALSE(fit_force({}, 0.0175));
  EXPECT_FALSE(fit_force({{0, 0}, {1, 100}, {1, 101}, {0, 2}}, 0.0175)) << "two forces";
  EXPECT_FALSE(fit_force(readings_of(0, 100), 0.0175)) << "it does not move";
  EXPECT_FALSE(fit_force(readings_of(-1, 100), 0.0175)) << "upside down";
  EXPECT_FALSE(fit_force(readings_of(9, 100), 0.0175));
  auto helped = readings_of(1, 100);
  helped[3].shown_gram += 120;
  EXPECT_FALSE(fit_force(helped, 0.0175)) << "a hand pressed too";
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(fit_force({{0, nan}, {1, 100}, {2, 200}}, 0.0175));
}

// 400 counts of the weakest arm that a configuration takes are 41 g.
TEST(ForceFit, TrustsNoLineOfAFewGrams) {
  const auto span_of = [](double gram) {
    return std::vector<ScaleReading>{{0, 200}, {0.5, 200 + gram / 2}, {1, 200 + gram}};
  };
  for (const double gram : {6.0, 15.0, 30.0, 39.9}) {
    const auto sut = fit_force(span_of(gram), 0.0175);
    ASSERT_FALSE(sut) << gram;
    EXPECT_NE(sut.error().message.find("more at the strongest force"), std::string::npos);
    EXPECT_NE(sut.error().message.find("--most"), std::string::npos) << sut.error().message;
  }
  EXPECT_TRUE(fit_force(span_of(41), 0.0175));
}

// Both ends may be off by a gram, each to its own side.
TEST(ForceFit, WhatItTrustsIsOffByAScalesGramsByFivePercentAtMost) {
  for (const double off_gram : {-1.0, 1.0}) {
    const auto sut = fit_force({{0, 200 - off_gram}, {1, 250}, {2, 300 + off_gram}}, 0.0175);
    const auto exact = fit_force({{0, 200}, {1, 250}, {2, 300}}, 0.0175);
    ASSERT_TRUE(sut && exact);
    EXPECT_NEAR(sut->newton_per_count / exact->newton_per_count, 1, 2 / 100.0 + 1e-9);
  }
  EXPECT_LE(2 / kLeastSpan_gram, 0.05);
}

TEST(ForceFit, TheRiseIsFromTheWeakestForceToTheStrongest) {
  EXPECT_EQ(rise_gram({}), 0);
  EXPECT_EQ(rise_gram({{1, 90}}), 0);
  EXPECT_EQ(rise_gram({{0, 100}, {1, 115}}), 15);
  EXPECT_EQ(rise_gram({{1, 115}, {0.5, 300}, {0, 100}}), 15) << "in any order";
  EXPECT_EQ(rise_gram({{0, 100}, {1, 85}}), -15) << "it pulls up";
}

TEST(ForceFit, NeverGivesANumberThatIsNone) {
  std::mt19937 dice(4);
  for (int round = 0; round < 20000; ++round) {
    std::vector<ScaleReading> readings(dice() % 8);
    for (ScaleReading& reading : readings) {
      reading.pressed_newton = 0.5 * static_cast<double>(dice() % 10);
      reading.shown_gram =
          std::ldexp(static_cast<double>(dice() % 1000), static_cast<int>(dice() % 9));
    }
    const auto sut = fit_force(readings, 0.0175);
    if (!sut) continue;
    ASSERT_GE(sut->newton_per_count, 0.0175 * 0.05);
    ASSERT_LE(sut->newton_per_count, 0.0175 * 5);
  }
}

TEST(ForceFit, ReadsGramsAsPeopleTypeThem) {
  for (const char* good : {"123", " 123 ", "123g", "123 g", "123.0", "123,0", "123\r"}) {
    EXPECT_EQ(parse_gram(good).value_or(-1), 123) << good;
  }
  EXPECT_EQ(parse_gram("-4").value_or(0), -4);
  for (const char* bad : {"", " ", "g", "12 3", "1e3", "nan", "inf", "0x10", "12kg", "20001"}) {
    EXPECT_FALSE(parse_gram(bad)) << bad;
  }
}

}  // namespace
}  // namespace thimble::cli
