#include "daemon/servo/velocity_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace thimble::servo {
namespace {

MonotonicTime at(double s) { return {from_seconds(s)}; }

TEST(VelocityFilter, ConvergesToASteadyVelocity) {
  VelocityFilter sut;
  for (int i = 0; i <= 200; ++i) sut.update(at(i * 1e-3), {0.2 * i * 1e-3, 0, -0.1 * i * 1e-3});
  EXPECT_NEAR(sut.velocity().x, 0.2, 1e-6);
  EXPECT_NEAR(sut.velocity().z, -0.1, 1e-6);
}

TEST(VelocityFilter, TheFirstSampleAndARepeatedTimeSayNothing) {
  VelocityFilter sut;
  EXPECT_EQ(sut.update(at(1), {5, 5, 5}), Velocity3{});
  EXPECT_EQ(sut.update(at(1), {6, 5, 5}), Velocity3{});
}

TEST(VelocityFilter, AStepOfTheHandDecaysWithTheTimeConstantAtAnyRate) {
  for (const double rate_hz : {500.0, 1000.0, 4000.0}) {
    VelocityFilter sut(80.0);
    const double dt_s = 1.0 / rate_hz;
    double t_s = 0;
    for (; t_s < 0.1; t_s += dt_s) sut.update(at(t_s), {0.3 * t_s, 0, 0});
    const double start = sut.velocity().x;
    const double stop_s = t_s;
    const Position3 rest{0.3 * (stop_s - dt_s), 0, 0};
    for (; t_s < stop_s + 0.01; t_s += dt_s) sut.update(at(t_s), rest);
    const double expected = start * std::exp(-2 * std::numbers::pi * 80.0 * 0.01);
    EXPECT_NEAR(sut.velocity().x, expected, 0.35 * expected) << rate_hz;
  }
}

TEST(VelocityFilter, ResetForgets) {
  VelocityFilter sut;
  sut.update(at(0), {});
  sut.update(at(0.001), {1, 0, 0});
  sut.reset();
  EXPECT_EQ(sut.velocity(), Velocity3{});
  EXPECT_EQ(sut.update(at(0.002), {9, 0, 0}), Velocity3{}) << "no jump from the old position";
}

}  // namespace
}  // namespace thimble::servo
