#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <random>

#include "daemon/coupling/energy_observer.hpp"
#include "daemon/coupling/ghost_point_arm.hpp"

namespace thimble::coupling {
namespace {

constexpr double kDepth_m = 0.002;

// A tip led over a floor at z = 0 whose matter is below.
class Floor {
 public:
  explicit Floor(double friction, double rate_hz = 1000, GhostPointSettings settings = {})
      : dt_s_(1 / rate_hz), sut_(settings) {
    ConstraintPlane plane{.normal = {0, 0, -1}, .offset_m = 0};
    plane.surface.friction = friction;
    set_.sequence = set_.session = 1;
    set_.planes.push_back(plane);
    sut_.reset(now_, tip_);
    go_to(tip_);
  }
  Force3 go_to(Position3 tip) {
    ++set_.sequence;  // the world answers each step, else its constraints would fade
    const Displacement3 way = tip - tip_;
    const Velocity3 velocity{way.x / dt_s_, way.y / dt_s_, way.z / dt_s_};
    const Duration dt = from_seconds(dt_s_);
    now_ = now_ + dt;
    energy.add(last_force_, velocity, dt);  // held since the previous step
    tip_ = tip;
    const ArmOutput output = sut_.step({.now = now_,
                                        .dt = dt,
                                        .tip = tip,
                                        .tip_velocity = velocity,
                                        .buttons = 0,
                                        .fresh = &set_,
                                        .link = {true, {}, {}}});
    last_force_ = output.force;
    return output.force;
  }
  // In a straight line, at a speed; the force at its end.
  Force3 glide_to(Position3 to, double speed_m_per_s) {
    const Displacement3 way = to - tip_;
    const double length_m = std::sqrt(dot(way, way));
    const auto steps = static_cast<int>(std::ceil(length_m / (speed_m_per_s * dt_s_)));
    const Position3 from = tip_;
    Force3 force{};
    for (int i = 1; i <= steps; ++i) force = go_to(from + (1.0 * i / steps) * way);
    return force;
  }
  EnergyObserver energy{};

 private:
  double dt_s_;
  MonotonicTime now_{};
  Position3 tip_{0, 0, 0.0001};
  Force3 last_force_{};
  ConstraintSet set_{};
  GhostPointArm sut_;
};

TEST(Friction, SlidingIsHeldBackByItsShareOfTheWall) {
  Floor sut(0.3);
  sut.glide_to({0, 0, -kDepth_m}, 0.02);
  const Force3 force = sut.glide_to({0.02, 0, -kDepth_m}, 0.05);
  EXPECT_NEAR(force.z, 800 * kDepth_m, 1e-9);
  EXPECT_NEAR(force.x, -0.3 * 800 * kDepth_m, 1e-6);
  EXPECT_NEAR(force.y, 0, 1e-9);
  EXPECT_GT(sut.glide_to({0.01, 0, -kDepth_m}, 0.05).x, 0.4);  // on the way back it holds forward
}

TEST(Friction, WithoutItNothingIsFeltAlongTheWall) {
  for (const double none : {0.0, -1.0, std::nan("")}) {
    Floor sut(none);
    sut.glide_to({0, 0, -kDepth_m}, 0.02);
    const Force3 force = sut.glide_to({0.02, 0.01, -kDepth_m}, 0.05);
    EXPECT_EQ(force.x, 0);
    EXPECT_EQ(force.y, 0);
  }
}

TEST(Friction, AWorldsWishIsBounded) {
  Floor sut(std::numeric_limits<double>::infinity());
  sut.glide_to({0, 0, -kDepth_m}, 0.02);
  EXPECT_NEAR(sut.glide_to({0.02, 0, -kDepth_m}, 0.05).x, -800 * kDepth_m, 1e-6);
}

TEST(Friction, DependsOnTheWayNotOnTheRate) {
  const auto force_at = [](double rate_hz) {
    Floor sut(0.4, rate_hz);
    sut.glide_to({0, 0, -kDepth_m}, 0.02);
    sut.glide_to({0.01, 0, -kDepth_m}, 0.05);
    return sut.glide_to({0.008, 0.006, -kDepth_m}, 0.05);
  };
  const Force3 reference = force_at(8000);
  for (const double rate_hz : {500.0, 1000.0, 2000.0}) {
    const Force3 force = force_at(rate_hz);
    EXPECT_NEAR(force.x, reference.x, 0.03) << rate_hz;
    EXPECT_NEAR(force.y, reference.y, 0.03) << rate_hz;
  }
}

TEST(Friction, ARestingTipIsLeftInPeace) {
  Floor sut(0.5);
  sut.glide_to({0, 0, -kDepth_m}, 0.02);
  sut.glide_to({0.0005, 0, -kDepth_m}, 0.05);
  sut.go_to({0.0005, 0, -kDepth_m});
  const Force3 held = sut.go_to({0.0005, 0, -kDepth_m});
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(sut.go_to({0.0005, 0, -kDepth_m}), held);
  EXPECT_EQ(sut.go_to({0.0005, 0, 0.001}), Force3{});
}

// Whatever the hand does: no pull towards the wall, never more than the share, no energy.
TEST(Friction, RandomRubbingIsPassive) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> side(-0.01, 0.01);
    std::uniform_real_distribution<double> depth(-0.003, 0.001);
    Floor with(0.6);
    Floor without(0);
    for (int leg = 0; leg < 60; ++leg) {
      const Position3 to{side(random), side(random), depth(random)};
      const Force3 force = with.glide_to(to, 0.05);
      const Force3 wall = without.glide_to(to, 0.05);
      ASSERT_GE(force.z, 0);
      ASSERT_EQ(force.z, wall.z);
      ASSERT_LE(norm(force.x, force.y, 0), 0.6 * 800 * std::max(0.0, -to.z) + 1e-9);
    }
    EXPECT_LE(with.energy.given_joule(), without.energy.given_joule() + 1e-9) << seed;
    EXPECT_LE(with.energy.generated_joule(), without.energy.generated_joule() + 1e-5) << seed;
  }
}

}  // namespace
}  // namespace thimble::coupling
