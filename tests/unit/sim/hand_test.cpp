#include "sim/model/hand/hand.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/allocation_count.hpp"

namespace thimble::sim {
namespace {

constexpr Duration kSubstep{100'000};

// A free point mass as the tip, pushed by `push` and by the hand.
struct FreeTip {
  Position3 position{};
  Velocity3 velocity{};
  MonotonicTime now{};

  void run(plugin::TipLoad& hand, double duration_s, Force3 push = {}) {
    constexpr double kMass = 0.06;
    for (double t = 0; t < duration_s; t += seconds(kSubstep)) {
      const Force3 force = hand.force_on_tip(now, kSubstep, position, velocity) + push;
      for (std::size_t i = 0; i < 3; ++i) {
        velocity[i] += force[i] / kMass * seconds(kSubstep);
        position[i] += velocity[i] * seconds(kSubstep);
      }
      now = now + kSubstep;
    }
  }
};

HandSettings still() {
  HandSettings settings;
  settings.motion = HandMotion::Still;
  return settings;
}

TEST(Hand, TakesHoldWhereTheTipIsWithoutAJerk) {
  Hand sut(still());
  FreeTip tip{.position = {0.05, -0.02, 0.01}};
  const Position3 before = tip.position;

  EXPECT_EQ(sut.force_on_tip({}, kSubstep, tip.position, {}), Force3{});
  tip.run(sut, 1);

  EXPECT_LT(norm(tip.position - before), 1e-12);
}

TEST(Hand, GivesWayToASteadyForceAsItsStiffnessSays) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Hand sut(still());
    FreeTip tip;
    sut.start_motion();
    tip.run(sut, 0.5);
    Force3 push{};
    push[axis] = -2;

    tip.run(sut, 4, push);

    EXPECT_NEAR(tip.position[axis], -2.0 / 200 - 2.0 / 5000, 1e-5);
    EXPECT_NEAR(sut.force()[axis], 2, 1e-3) << "pushes back what it feels";
    EXPECT_NEAR(sut.finger().position[axis], -2.0 / 200, 1e-5);
  }
}

TEST(Hand, ComesBackWhenTheForceGoes) {
  Hand sut(still());
  FreeTip tip;
  sut.start_motion();
  tip.run(sut, 1, {3, 0, 0});
  ASSERT_GT(tip.position.x, 0.01);

  tip.run(sut, 3);

  EXPECT_LT(norm(tip.position - Position3{}), 1e-5);
  EXPECT_LT(norm(tip.velocity), 1e-4);
}

TEST(Hand, GoesWhereItIsSentInTimeAndHoldsFirmly) {
  for (const Position3 target : {Position3{0.1, 0.05, -0.08}, Position3{1e-4, 0, 0}, Position3{}}) {
    Hand sut(still());
    FreeTip tip;
    sut.hold_at(target, Duration(400'000'000));

    tip.run(sut, 0.4);
    EXPECT_LT(norm(sut.reference().position - target), 1e-9);
    tip.run(sut, 0.15);
    EXPECT_LT(norm(tip.position - target), 1e-4);
    tip.run(sut, 0.5, {0, 1, 0});
    EXPECT_NEAR(tip.position.y - target.y, 1.0 / 2000 + 1.0 / 5000, 1e-5);
  }
}

TEST(Hand, PlaysItsMotionFromTheOriginOnceItGotThere) {
  HandSettings settings;
  settings.motion = HandMotion::Poke;
  Hand sut(settings);
  FreeTip tip{.position = {0, 0.03, 0}};
  sut.start_motion();
  tip.run(sut, 0.1);
  EXPECT_FALSE(sut.is_in_motion());
  tip.run(sut, 0.3);
  EXPECT_TRUE(sut.is_in_motion());
  tip.run(sut, 0.3);
  EXPECT_GT(tip.position.x, 0.012);
  EXPECT_LT(std::abs(tip.position.y), 0.003);
}

TEST(Hand, ReferenceDoesNotJumpWhenItsTaskChanges) {
  Hand sut(HandSettings{});
  FreeTip tip{.position = {0.02, 0.1, 0}};
  PathPoint last = {tip.position, {}};
  for (int i = 0; i < 60'000; ++i) {
    if (i == 100) sut.hold_at({0, 0.02, 0.01}, Duration(300'000'000));
    if (i == 10'000) sut.start_motion();
    if (i == 40'000) sut.hold_at({0, 0, 0}, Duration(200'000'000));
    tip.run(sut, 0.9 * seconds(kSubstep));
    ASSERT_LT(norm(sut.reference().position - last.position), 1.0 * seconds(kSubstep)) << i;
    last = sut.reference();
  }
}

TEST(Hand, AllocatesNothing) {
  Hand sut(HandSettings{});
  FreeTip tip;
  const std::uint64_t before = test::allocation_count();
  sut.start_motion();
  tip.run(sut, 2);
  EXPECT_EQ(test::allocation_count(), before);
}

TEST(HandSettings, NamesEveryMotionByOneWord) {
  for (const HandMotion motion : kHandMotions) {
    EXPECT_EQ(parse_hand_motion(to_string(motion)), motion);
  }
  EXPECT_EQ(parse_hand_motion("explore"), HandMotion::Explore);
  EXPECT_FALSE(parse_hand_motion("Explore").has_value());
  EXPECT_FALSE(parse_hand_motion("").has_value());
}

TEST(HandSettings, RefusesWhatNoHandIs) {
  EXPECT_TRUE(check(HandSettings{}).has_value());
  const auto refused = [](auto change) {
    HandSettings settings;
    change(settings);
    return !check(settings).has_value();
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(refused([](HandSettings& s) { s.axis = 3; }));
  EXPECT_TRUE(refused([](HandSettings& s) { s.speed_m_per_s = 0; }));
  EXPECT_TRUE(refused([](HandSettings& s) { s.speed_m_per_s = 0.6; }));
  EXPECT_TRUE(refused([](HandSettings& s) { s.reach_m = -0.001; }));
  EXPECT_TRUE(refused([](HandSettings& s) { s.mass_kg = 0; }));
  EXPECT_TRUE(refused([&](HandSettings& s) { s.stiffness_newton_per_m = nan; }));
  EXPECT_TRUE(refused([&](HandSettings& s) { s.damping_newton_s_per_m = -1; }));
  EXPECT_TRUE(refused([&](HandSettings& s) { s.contact_newton_per_m = 1e6; }));
}

}  // namespace
}  // namespace thimble::sim
