#include "daemon/servo/wrench_limiter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace thimble::servo {
namespace {

constexpr Duration kTick = std::chrono::milliseconds(1);

LimiterSettings limits() {
  LimiterSettings settings;
  settings.max_force_newton = 5;
  settings.peak_current_a = {3, 3, 3};
  settings.continuous_current_a = {1, 1, 1};
  return settings;
}

Matrix3 diagonal(double a) {
  Matrix3 m;
  for (std::size_t i = 0; i < 3; ++i) m.row[i][i] = a;
  return m;
}

LimiterInput asks(Force3 wish, double gain = 1.0, double ampere_per_newton = 0.01) {
  return {.wish = wish,
          .motor_current_per_force = diagonal(ampere_per_newton),
          .gain = gain,
          .dt = kTick};
}

LimiterOutput settle(WrenchLimiter& sut, const LimiterInput& input, int ticks = 50) {
  LimiterOutput out;
  for (int i = 0; i < ticks; ++i) out = sut.limit(input);
  return out;
}

TEST(WrenchLimiter, PassesAModestForceUnchanged) {
  WrenchLimiter sut(limits());
  const LimiterOutput out = settle(sut, asks({0.3, -0.2, 0.1}));
  EXPECT_EQ(out.wrench.force(), (Force3{0.3, -0.2, 0.1}));
  EXPECT_FALSE(out.is_norm_clamped || out.is_rise_limited || out.is_current_clamped);
}

TEST(WrenchLimiter, ClampsTheNormAndKeepsTheDirection) {
  WrenchLimiter sut(limits());
  const Force3 force = settle(sut, asks({30, -40, 0})).wrench.force();
  EXPECT_NEAR(norm(force), 5, 1e-12);
  EXPECT_NEAR(force.x / force.y, -0.75, 1e-12);
}

TEST(WrenchLimiter, RaisesTheForceNoFasterThanTheRate) {
  WrenchLimiter sut(limits());
  double previous = 0;
  for (int i = 0; i < 20; ++i) {
    const double now = norm(sut.limit(asks({0, 4, 0})).wrench.force());
    EXPECT_LE(now - previous, 1.0 + 1e-12) << "1000 N/s over 1 ms";
    previous = now;
  }
  EXPECT_EQ(previous, 4);
}

TEST(WrenchLimiter, LetsTheForceFallAtOnce) {
  WrenchLimiter sut(limits());
  settle(sut, asks({4, 0, 0}));
  EXPECT_EQ(sut.limit(asks({0.5, 0, 0})).wrench.force(), (Force3{0.5, 0, 0}));
  EXPECT_EQ(sut.limit(asks({0, 0, 0})).wrench.force(), Force3{});
}

TEST(WrenchLimiter, AReversalStartsFromZero) {
  WrenchLimiter sut(limits());
  settle(sut, asks({4, 0, 0}));
  EXPECT_NEAR(sut.limit(asks({-4, 0, 0})).wrench.force().x, -1, 1e-12);
}

TEST(WrenchLimiter, ClampsEachJointsCurrentAlongTheSameDirection) {
  WrenchLimiter sut(limits());
  LimiterInput input = asks({1, 2, 2});
  input.motor_current_per_force = diagonal(0);
  input.motor_current_per_force.row[1] = {0, 3, 0};  // 6 A asked of a 3 A motor

  const LimiterOutput out = settle(sut, input, 3);

  EXPECT_TRUE(out.is_current_clamped);
  EXPECT_NEAR(out.wrench.force().y * 3, 3, 1e-9);
  EXPECT_NEAR(out.wrench.force().x / out.wrench.force().y, 0.5, 1e-9);
}

TEST(WrenchLimiter, RejectsCurrentsBeyondAllNumbersAndBoundsTheNextAsBefore) {
  const double huge = std::numeric_limits<double>::max();
  for (const Matrix3& matrix :
       {diagonal(huge), Matrix3{{{{huge, -huge, 0}, {huge, huge, 0}, {0, 0, 1}}}}}) {
    WrenchLimiter sut(limits());
    LimiterInput input = asks({4, 4, 0});
    settle(sut, input);
    input.motor_current_per_force = matrix;
    const LimiterOutput out = sut.limit(input);
    EXPECT_EQ(out.fault, FaultCode::NonFiniteState);
    EXPECT_EQ(out.wrench.force(), Force3{});
    // 10 A/N, of which the peak lets 3 A through, and the heat 1 A in the end.
    const LimiterOutput bound = settle(sut, asks({4, 0, 0}, 1.0, 10), 100'000);
    EXPECT_EQ(bound.fault, FaultCode::None);
    EXPECT_LE(norm(bound.wrench.force()), 0.3 + 1e-12);
    EXPECT_TRUE(bound.is_heat_limited);
  }
}

TEST(WrenchLimiter, RejectsEveryNonFiniteInputAndGivesZero) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinity, -infinity}) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      WrenchLimiter sut(limits());
      settle(sut, asks({1, 1, 1}));
      Force3 wish{1, 1, 1};
      wish[axis] = bad;
      const LimiterOutput out = sut.limit(asks(wish));
      EXPECT_EQ(out.fault, FaultCode::NonFiniteForce);
      EXPECT_EQ(out.wrench.force(), Force3{});

      LimiterInput matrix = asks({1, 1, 1});
      matrix.motor_current_per_force.row[axis][0] = bad;
      EXPECT_EQ(sut.limit(matrix).fault, FaultCode::NonFiniteState);
      EXPECT_EQ(sut.limit(asks({1, 1, 1}, bad)).fault, FaultCode::NonFiniteForce);
    }
  }
}

TEST(WrenchLimiter, TheGainScalesAndNeverAmplifies) {
  WrenchLimiter sut(limits());
  EXPECT_NEAR(settle(sut, asks({2, 0, 0}, 0.25)).wrench.force().x, 0.5, 1e-12);
  EXPECT_NEAR(settle(sut, asks({2, 0, 0}, 7.0)).wrench.force().x, 2, 1e-12);
  EXPECT_EQ(settle(sut, asks({2, 0, 0}, -1.0)).wrench.force(), Force3{});
}

TEST(WrenchLimiter, AHotMotorIsHeldToItsContinuousCurrent) {
  WrenchLimiter sut(limits());
  const LimiterInput hard = asks({5, 0, 0}, 1.0, 0.6);  // asks 3 A of a 1 A motor
  EXPECT_NEAR(settle(sut, hard, 20).wrench.force().x * 0.6, 3, 1e-9) << "peak while cold";

  const LimiterOutput out = settle(sut, hard, 60'000);

  EXPECT_TRUE(out.is_heat_limited);
  EXPECT_LE(sut.motor_heat()[0], 1.0 + 1e-6);
  EXPECT_NEAR(out.wrench.force().x * 0.6, 1, 0.12) << "continuous when hot";
}

TEST(WrenchLimiter, AMotorCoolsWhileNothingIsAsked) {
  WrenchLimiter sut(limits());
  settle(sut, asks({5, 0, 0}, 1.0, 0.6), 60'000);
  for (int i = 0; i < 60'000; ++i) sut.cut(kTick);
  EXPECT_LT(sut.motor_heat()[0], 0.01);
}

TEST(WrenchLimiter, RandomProgramsNeverBreakAnyLimit) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> wish(-50, 50);
  std::uniform_real_distribution<double> current(-2, 2);
  std::uniform_real_distribution<double> gain(-0.5, 1.5);
  WrenchLimiter sut(limits());
  Force3 previous{};
  for (int i = 0; i < 20'000; ++i) {
    LimiterInput input = asks({wish(random), wish(random), wish(random)}, gain(random));
    for (auto& row : input.motor_current_per_force.row) {
      for (double& cell : row) cell = current(random);
    }
    if (random() % 50 == 0) input.wish.x = std::numeric_limits<double>::quiet_NaN();

    const Force3 force = sut.limit(input).wrench.force();

    ASSERT_TRUE(is_finite(force));
    ASSERT_LE(norm(force), 5 + 1e-9);
    for (const auto& row : input.motor_current_per_force.row) {
      ASSERT_LE(std::abs(row[0] * force.x + row[1] * force.y + row[2] * force.z), 3 + 1e-9);
    }
    // Oracle for the rise: no point of the segment zero..previous is nearer than it allows.
    double nearest = norm(force);
    for (int k = 0; k <= 200; ++k)
      nearest = std::min(nearest, norm(force - (k / 200.0) * previous));
    ASSERT_LE(nearest, 1.0 + 2.5e-2);
    previous = force;
  }
}

TEST(MakeLimiterSettings, AConfigurationCanOnlyTighten) {
  HapticCapabilities arm;
  arm.peak_force_newton = 5;
  arm.peak_current_a = {3, 3, 3};
  arm.continuous_current_a = {1, 1, 1};

  EXPECT_EQ(make_limiter_settings(arm, {})->max_force_newton, 5);
  EXPECT_EQ(make_limiter_settings(arm, {.force_newton = 2})->max_force_newton, 2);
  EXPECT_EQ(make_limiter_settings(arm, {.force_newton = 9})->max_force_newton, 5);
  EXPECT_FALSE(make_limiter_settings(arm, {.rise_newton_per_s = 2000}));
}

TEST(MakeLimiterSettings, AMotorHasNoMoreThanTheForceNeedsInTheWorkspace) {
  HapticCapabilities arm;
  arm.peak_force_newton = 5;
  arm.peak_current_a = {3, 3, 3};
  arm.continuous_current_a = {1, 1, 1};
  arm.most_current_a_per_newton = {0.5, 2, 0};
  const auto at_peak = make_limiter_settings(arm, {});
  EXPECT_EQ(at_peak->peak_current_a, (std::array{2.5, 3.0, 3.0}));
  EXPECT_EQ(at_peak->continuous_current_a, (std::array{1.0, 1.0, 1.0}));
  const auto small = make_limiter_settings(arm, {.force_newton = 0.1});
  EXPECT_EQ(small->peak_current_a, (std::array{0.05, 0.2, 3.0}));
  EXPECT_EQ(small->continuous_current_a, (std::array{0.05, 0.2, 1.0}));

  // A pose in which a newton asks for ten times as much: told by a liar, or near full stretch.
  WrenchLimiter sut(*small);
  Matrix3 current_per_force;
  current_per_force.row[0] = {5, 0, 0};
  const LimiterOutput out = sut.limit({{0.1, 0, 0}, current_per_force, 1, Duration(1'000'000)});
  EXPECT_TRUE(out.is_current_clamped);
  EXPECT_NEAR(out.wrench.force().x, 0.01, 1e-12);
}

TEST(MakeLimiterSettings, RefusesNumbersThatAreNoLimit) {
  HapticCapabilities arm;
  arm.peak_force_newton = 5;
  arm.peak_current_a = {3, 3, 3};
  arm.continuous_current_a = {1, 1, 1};
  const double infinity = std::numeric_limits<double>::infinity();

  for (const double bad : {std::nan(""), infinity, -1.0}) {
    EXPECT_FALSE(make_limiter_settings(arm, {.force_newton = bad})) << bad;
    EXPECT_FALSE(make_limiter_settings(arm, {.rise_newton_per_s = bad})) << bad;
    for (std::size_t joint = 0; joint < 3; ++joint) {
      HapticCapabilities other = arm;
      other.peak_current_a[joint] = bad;
      EXPECT_FALSE(make_limiter_settings(other, {})) << joint << " " << bad;
      other = arm;
      other.most_current_a_per_newton[joint] = bad;
      EXPECT_EQ(make_limiter_settings(other, {}).has_value(), bad == infinity)
          << joint << " " << bad;
    }
  }
  for (const double bad : {std::nan(""), 0.0, -1.0}) {
    HapticCapabilities other = arm;
    other.continuous_current_a[2] = bad;
    EXPECT_FALSE(make_limiter_settings(other, {})) << bad;
    EXPECT_FALSE(make_limiter_settings(arm, {.rise_newton_per_s = bad})) << bad;
  }
}

TEST(MakeLimiterSettings, ContinuousCurrentIsNeverAboveThePeak) {
  HapticCapabilities arm;
  arm.peak_force_newton = 5;
  arm.peak_current_a = {3, 3, 3};
  arm.continuous_current_a = {9, std::numeric_limits<double>::infinity(), 1};
  EXPECT_EQ(make_limiter_settings(arm, {})->continuous_current_a, (std::array{3.0, 3.0, 1.0}));
}

TEST(MakeLimiterSettings, RefusesAnArmWithoutKnownLimits) {
  HapticCapabilities arm;
  arm.peak_current_a = {3, 3, 3};
  arm.continuous_current_a = {1, 1, 1};
  EXPECT_FALSE(make_limiter_settings(arm, {})) << "no peak force and none configured";
  EXPECT_TRUE(make_limiter_settings(arm, {.force_newton = 2}));

  arm.peak_current_a[1] = 0;
  const auto refused = make_limiter_settings(arm, {.force_newton = 2});
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("motor 2"), std::string::npos);
}

TEST(MakeLimiterSettings, AnArmWithoutMotorsGetsNoForceWhateverIsAsked) {
  HapticCapabilities puck;
  puck.is_actuated = false;
  for (const double configured_newton : {0.0, 3.0}) {
    const auto settings = make_limiter_settings(puck, {.force_newton = configured_newton});
    ASSERT_TRUE(settings);
    WrenchLimiter sut(*settings);
    for (const double wish_newton : {1e-300, 1.0, 1e300}) {
      const LimiterOutput out =
          sut.limit({{wish_newton, 0, -wish_newton}, {}, 1.0, std::chrono::milliseconds(1)});
      EXPECT_EQ(norm(out.wrench.force()), 0);
      EXPECT_EQ(out.fault, FaultCode::None);
      EXPECT_EQ(sut.motor_heat(), (std::array{0.0, 0.0, 0.0}));
    }
  }
}

}  // namespace
}  // namespace thimble::servo
