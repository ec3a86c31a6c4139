#include "daemon/coupling/arm_pair.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include "daemon/coupling/ghost_point_arm.hpp"
#include "daemon/coupling/spring_damper_arm.hpp"
#include "daemon/coupling/wave_arm.hpp"
#include "pair_loop.hpp"

namespace thimble::coupling {
namespace {

using testing::PairLoop;

SpringDamperSettings between_arms() {
  SpringDamperSettings settings;
  settings.force_at = ForceAt::Both;
  settings.is_between_arms = true;
  settings.tool.stiffness = {400};
  return settings;
}

enum class Peers { SpringDamper, Wave, Touch };

struct Pair {
  explicit Pair(Peers peers, const link::ImpairmentSettings& impairment)
      : first(make(peers, true)),
        second(make(peers, false)),
        loop(*first, *second, peers == Peers::Touch ? PeerAnswer::Touch : PeerAnswer::Motion,
             impairment) {}
  static std::unique_ptr<ArmCoupling> make(Peers peers, bool is_first) {
    if (peers == Peers::Wave) return std::make_unique<WaveArm>();
    if (peers == Peers::SpringDamper || !is_first) {
      return std::make_unique<SpringDamperArm>(between_arms());
    }
    return std::make_unique<GhostPointArm>(GhostPointSettings{});
  }
  void tick() {
    loop.tick();
    largest_offset_m = std::max(largest_offset_m, norm(loop.outputs[0].offset));
  }
  void run(double s) {
    for (int i = 0; i < static_cast<int>(s * 1000); ++i) tick();
  }
  // The first hand goes there at 0.1 m/s, the second follows or holds.
  void lead(double to_m) {
    testing::PairedArm& hand = loop.arms[0];
    const double sign = to_m > hand.reference_m ? 1 : -1;
    hand.reference_m_per_s = sign * 0.1;
    while (sign * (to_m - hand.reference_m) > 0) {
      hand.reference_m += sign * 1e-4;
      tick();
    }
    hand.reference_m_per_s = 0;
  }
  std::unique_ptr<ArmCoupling> first;
  std::unique_ptr<ArmCoupling> second;
  PairLoop loop;
  double largest_offset_m{0};
};

// An arm that nobody holds, with the friction of its own joints.
void leave_alone(testing::PairedArm& arm) {
  arm.mass_kg = 0.1;
  arm.hand_newton_per_m = 0;
  arm.hand_newton_s_per_m = 0;
}

class ArmPairTest : public ::testing::TestWithParam<Peers> {};
INSTANTIATE_TEST_SUITE_P(, ArmPairTest,
                         ::testing::Values(Peers::SpringDamper, Peers::Wave, Peers::Touch),
                         [](const auto& of) {
                           return std::string(of.param == Peers::SpringDamper ? "SpringDamper"
                                              : of.param == Peers::Wave       ? "Wave"
                                                                              : "Touch");
                         });

TEST_P(ArmPairTest, AnArmThatNobodyHoldsFollowsAndRestsWhereTheOtherRests) {
  for (const double delay_s : {0.0, 0.01, 0.05, 0.1, 0.25}) {
    Pair sut(GetParam(), {.delay_s = delay_s});
    leave_alone(sut.loop.arms[1]);
    sut.run(0.2 + 2 * delay_s);
    sut.lead(0.03);
    sut.run(GetParam() == Peers::Wave ? 20 + 160 * delay_s : 5);
    EXPECT_NEAR(sut.loop.arms[1].x_m, sut.loop.arms[0].x_m, 0.3e-3) << delay_s;
    EXPECT_NEAR(sut.loop.arms[0].x_m, 0.03, 0.3e-3) << delay_s;
    EXPECT_LT(norm(sut.loop.outputs[0].force), 0.05) << delay_s;
  }
}

// Thesis 5.3.5: force is shared, not only position.
TEST_P(ArmPairTest, EachFeelsWhatTheOtherPressesAgainst) {
  for (const double delay_s : {0.0, 0.01, 0.05, 0.1, 0.25}) {
    Pair sut(GetParam(), {.delay_s = delay_s});
    leave_alone(sut.loop.arms[1]);
    sut.loop.arms[1].wall_m = 0.015;
    sut.run(0.2 + 2 * delay_s);
    sut.loop.arms[0].hand_newton_per_m = 0;
    sut.loop.arms[0].hand_newton_s_per_m = 20;
    sut.loop.arms[0].push_newton = 2;
    sut.run(10 + 160 * delay_s);
    const double felt_newton = -sut.loop.outputs[0].force.x;
    const double pressed_newton = -sut.loop.arms[1].from_wall_newton;
    EXPECT_NEAR(felt_newton, 2, 0.02) << delay_s;
    // The ghost point's coordinate spring is felt on top: at most half of the wall.
    const double most = GetParam() == Peers::Touch ? 1.55 : 1.05;
    EXPECT_LT(felt_newton, most * pressed_newton) << delay_s;
    EXPECT_GT(felt_newton, 0.95 * pressed_newton) << delay_s;
  }
}

TEST_P(ArmPairTest, IsStillAtEveryDelayAndGivesNoEnergy) {
  for (const double delay_s : {0.001, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25}) {
    for (const bool is_bad : {false, true}) {
      const link::ImpairmentSettings good{.delay_s = delay_s};
      const link::ImpairmentSettings bad{
          .delay_s = delay_s, .jitter_s = delay_s / 2, .loss = 0.05, .reorder = 0.05, .seed = 7};
      Pair sut(GetParam(), is_bad ? bad : good);
      // What springs back softer than K_c is no wall to the ghost point (decision 0445).
      if (GetParam() == Peers::Touch) leave_alone(sut.loop.arms[1]);
      sut.loop.arms[1].wall_m = 0.01;
      sut.run(0.2);
      sut.lead(0.04);
      sut.run(6);
      sut.lead(0.0);
      sut.run(4);
      sut.lead(0.03);
      sut.run(15);
      double least_m = 1;
      double most_m = -1;
      double given_joule = 0;
      for (int i = 0; i < 2000; ++i) {
        sut.loop.tick();
        least_m = std::min(least_m, sut.loop.arms[0].x_m);
        most_m = std::max(most_m, sut.loop.arms[0].x_m);
        const double slave_joule =
            GetParam() == Peers::Touch ? 0 : sut.loop.arms[1].energy.given_joule();
        given_joule = std::max(given_joule, sut.loop.arms[0].energy.given_joule() + slave_joule);
      }
      // A wall that gives way is told anew within the hysteresis.
      const double still_m = GetParam() == Peers::Touch ? 0.6e-3 : 0.5e-3;
      EXPECT_LT(most_m - least_m, still_m) << delay_s << ' ' << is_bad;
      // Of both arms together, but a slave that goes ahead unfelt goes by its own motors; a
      // millisecond of way from force to motor is the rest, and of the ghost point ½·k_o·o².
      const double shift_m = sut.largest_offset_m;
      EXPECT_LT(given_joule, 1e-3 + 25 * shift_m * shift_m) << delay_s << ' ' << is_bad;
    }
  }
}

TEST_P(ArmPairTest, AnArmWhosePeerIsSilentIsLetGoWithoutAJump) {
  Pair sut(GetParam(), {.delay_s = 0.02});
  leave_alone(sut.loop.arms[1]);
  sut.loop.arms[1].wall_m = 0.01;
  sut.run(0.2);
  sut.lead(0.05);
  sut.run(2);
  ASSERT_GT(norm(sut.loop.outputs[0].force), 0.3);
  sut.loop.is_up[1] = false;
  double largest_newton = 0;
  double before_newton = sut.loop.outputs[0].force.x;
  for (int i = 0; i < 600; ++i) {
    sut.loop.tick();
    largest_newton =
        std::max(largest_newton, std::abs(sut.loop.outputs[0].force.x - before_newton));
    before_newton = sut.loop.outputs[0].force.x;
  }
  EXPECT_LT(largest_newton, 1) << "teleop.md 5, G3: what the limiter takes";
  EXPECT_EQ(sut.loop.outputs[0].force, Force3{});
  EXPECT_TRUE(sut.loop.outputs[0].is_fading);
}

TEST_P(ArmPairTest, MirroredHandsAreMirrored) {
  const auto trace = [&](double sign) {
    Pair sut(GetParam(), {.delay_s = 0.03, .jitter_s = 0.01, .loss = 0.02, .seed = 3});
    std::mt19937_64 random(445);
    std::vector<double> rows;
    for (int i = 0; i < 3000; ++i) {
      if (i % 100 == 0) {
        for (auto& arm : sut.loop.arms) {
          arm.reference_m = sign * std::uniform_real_distribution<double>(-0.03, 0.03)(random);
        }
      }
      sut.loop.tick();
      rows.push_back(sign * sut.loop.outputs[0].force.x);
    }
    return rows;
  };
  EXPECT_EQ(trace(1), trace(-1));
}

TEST(ArmPair, NeitherArmIsStifferThanTheOther) {
  SpringDamperArm soft(between_arms());
  SpringDamperSettings harder = between_arms();
  harder.tool.stiffness = {800};
  SpringDamperArm hard(harder);
  PairLoop sut(soft, hard, PeerAnswer::Motion, {});
  for (int i = 0; i < 100; ++i) sut.tick();
  EXPECT_EQ(soft.stiffness().newton_per_m, 400);
  EXPECT_EQ(hard.stiffness().newton_per_m, 400);
}

// In the open nothing is told but the slave's place, however fast the master goes.
TEST(ArmPair, TheMasterFeelsNothingOfASlaveOnItsWay) {
  for (const double delay_s : {0.0, 0.02, 0.1, 0.25}) {
    Pair sut(Peers::Touch, {.delay_s = delay_s});
    leave_alone(sut.loop.arms[1]);
    sut.run(0.2 + 2 * delay_s);
    double largest_newton = 0;
    for (const double to_m : {0.03, -0.03, 0.01}) {
      sut.lead(to_m);
      for (int i = 0; i < 1000; ++i) {
        sut.loop.tick();
        largest_newton = std::max(largest_newton, norm(sut.loop.outputs[0].force));
      }
    }
    EXPECT_EQ(largest_newton, 0) << delay_s;
  }
}

HandSample said(std::uint64_t sequence, double x_m) {
  HandSample sample;
  sample.sequence = sequence;
  sample.hand = {x_m, 0, 0};
  return sample;
}

TEST(ArmPair, SaysNothingNewUntilTheOtherDoes) {
  const ArmPair pair(5);
  const auto first = pair.make_half(ArmPair::Side::First, PeerAnswer::Motion);
  const auto second = pair.make_half(ArmPair::Side::Second, PeerAnswer::Motion);
  ASSERT_TRUE(first->open(said(1, 0)));
  EXPECT_EQ(first->answer(said(1, 0), {}).sequence, 0U) << "there is no other";
  ASSERT_TRUE(second->open(said(1, 0.02)));
  EXPECT_EQ(second->answer(said(1, 0.02), {}).far.slave.x, 0);
  const ConstraintSet told = first->answer(said(2, 0), {});
  EXPECT_EQ(told.sequence, 1U);
  EXPECT_EQ(told.far.slave.x, 0.02);
  EXPECT_EQ(first->answer(said(3, 0), {}).sequence, 1U);
  (void)second->answer(said(2, 0.03), {});
  EXPECT_EQ(first->answer(said(4, 0), {}).far.slave.x, 0.03);
  second->close();
  EXPECT_EQ(first->answer(said(5, 0), {}).sequence, 2U);
}

TEST(ArmPair, AnArmThatStartsAgainIsAnotherSession) {
  const ArmPair pair(5);
  const auto first = pair.make_half(ArmPair::Side::First, PeerAnswer::Motion);
  const auto second = pair.make_half(ArmPair::Side::Second, PeerAnswer::Motion);
  ASSERT_TRUE(first->open(said(1, 0)));
  ASSERT_TRUE(second->open(said(1, 0)));
  HandSample sample = said(1, 0);
  sample.waves.distance.x = 7;
  (void)second->answer(sample, {});
  const std::uint32_t session = first->answer(said(2, 0), {}).session;
  second->close();
  sample.restart = 1;
  ASSERT_TRUE(second->open(sample));
  (void)second->answer(sample, {});
  const ConstraintSet told = first->answer(said(3, 0), {});
  EXPECT_NE(told.session, session);
  EXPECT_EQ(told.far.waves.distance.x, 0) << "what went before is nobody's";
}

// As when a real arm takes over from its stand-in: each counts its own starts.
TEST(ArmPair, AnotherArmWithTheSameCountIsAnotherSession) {
  const ArmPair pair(5);
  const auto first = pair.make_half(ArmPair::Side::First, PeerAnswer::Motion);
  const auto stand_in = pair.make_half(ArmPair::Side::Second, PeerAnswer::Motion);
  ASSERT_TRUE(first->open(said(1, 0)));
  ASSERT_TRUE(stand_in->open(said(1, 0)));
  HandSample sample = said(1, 0);
  sample.waves.distance.x = 7;
  (void)stand_in->answer(sample, {});
  const std::uint32_t session = first->answer(said(2, 0), {}).session;
  const auto arm = pair.make_half(ArmPair::Side::Second, PeerAnswer::Motion);
  sample.waves.distance.x = -3;
  ASSERT_TRUE(arm->open(sample));
  (void)arm->answer(sample, {});
  const ConstraintSet told = first->answer(said(3, 0), {});
  EXPECT_NE(told.session, session);
  EXPECT_EQ(told.far.waves.distance.x, 0) << "they are not the sums of the one before";
}

TEST(ArmPair, WhatWasSaidBeforeIsNothingNewToAnArmThatStartsAgain) {
  const ArmPair pair(5);
  const auto first = pair.make_half(ArmPair::Side::First, PeerAnswer::Motion);
  const auto second = pair.make_half(ArmPair::Side::Second, PeerAnswer::Motion);
  ASSERT_TRUE(first->open(said(1, 0)));
  ASSERT_TRUE(second->open(said(1, 0)));
  (void)second->answer(said(1, 0), {});
  EXPECT_EQ(first->answer(said(2, 0), {}).sequence, 1U);
  first->close();
  ASSERT_TRUE(first->open(said(3, 0)));
  EXPECT_EQ(first->answer(said(4, 0), {}).sequence, 0U) << "the other may have gone silent";
  (void)second->answer(said(2, 0), {});
  EXPECT_EQ(first->answer(said(5, 0), {}).sequence, 1U);
}

// A rig that takes over is opened before the one it replaces goes.
TEST(ArmPair, TheHalfThatIsReplacedTakesNothingWithIt) {
  const ArmPair pair(1);
  const auto first = pair.make_half(ArmPair::Side::First, PeerAnswer::Motion);
  auto before = pair.make_half(ArmPair::Side::Second, PeerAnswer::Motion);
  ASSERT_TRUE(first->open(said(1, 0)));
  ASSERT_TRUE(before->open(said(1, 0)));
  const auto after = pair.make_half(ArmPair::Side::Second, PeerAnswer::Motion);
  ASSERT_TRUE(after->open(said(1, 0.04)));
  before.reset();
  (void)after->answer(said(2, 0.04), {});
  EXPECT_EQ(first->answer(said(2, 0), {}).far.slave.x, 0.04);
}

// Energies that an arm does not tell are all that a guard between both ends lets its hand have.
TEST(ArmPair, RefusesAHandThatIsGuardedBetweenBothEnds) {
  const ArmPair pair(1);
  const auto sut = pair.make_half(ArmPair::Side::First, PeerAnswer::Motion);
  HandSample guarded = said(1, 0);
  guarded.energy_joule = 0;
  const auto opened = sut->open(guarded);
  ASSERT_FALSE(opened);
  EXPECT_NE(opened.error().message.find("needs a world that tells a force"), std::string::npos);
  EXPECT_TRUE(sut->open(said(1, 0)));
}

TEST(ArmPair, RefusesHandsThatAreNowhere) {
  const ArmPair pair(1);
  const auto first = pair.make_half(ArmPair::Side::First, PeerAnswer::Touch);
  const auto second = pair.make_half(ArmPair::Side::Second, PeerAnswer::Motion);
  EXPECT_FALSE(first->open(said(1, std::numeric_limits<double>::quiet_NaN())));
  ASSERT_TRUE(first->open(said(1, 0)));
  ASSERT_TRUE(second->open(said(1, 0)));
  HandSample sample = said(2, 0);
  sample.pull.x = std::numeric_limits<double>::infinity();
  (void)second->answer(sample, {});
  EXPECT_EQ(first->answer(said(2, 0), {}).sequence, 0U);
}

}  // namespace
}  // namespace thimble::coupling
