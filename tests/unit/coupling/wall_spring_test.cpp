#include "daemon/coupling/wall_spring.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace thimble::coupling {
namespace {

constexpr Stiffness kSoft{200};
constexpr Stiffness kHard{2000};

WallSpring plain(Stiffness stiffness) {
  WallSpring spring;
  spring.reset(stiffness);
  return spring;
}

TEST(WallSpring, PlainIsHookesLawAndNothingOutside) {
  const WallSpring sut = plain(kSoft);
  EXPECT_DOUBLE_EQ(sut.force_newton(0.01), 2);
  EXPECT_DOUBLE_EQ(sut.energy_joule(0.01), 0.01);
  EXPECT_EQ(sut.force_newton(0), 0);
  EXPECT_EQ(sut.force_newton(-0.01), 0);
  EXPECT_EQ(sut.energy_joule(-0.01), 0);
}

TEST(WallSpring, ThatHardensKeepsItsForceAndIsHardFromThereOn) {
  WallSpring sut = plain(kSoft);
  sut.become(kHard, 0.01);
  EXPECT_NEAR(sut.force_newton(0.01), 2, 1e-12);
  EXPECT_NEAR(sut.force_newton(0.011), 4, 1e-12);
  EXPECT_NEAR(sut.force_newton(0.005), 1, 1e-12);
}

TEST(WallSpring, ThatSoftensIsThePlainSoftWallAtOnce) {
  WallSpring sut = plain(kHard);
  sut.become(kSoft, 0.01);
  for (const double depth_m : {0.001, 0.01, 0.02}) {
    EXPECT_NEAR(sut.force_newton(depth_m), 200 * depth_m, 1e-12) << depth_m;
  }
}

// A finger that rubs over stripes with a steady push comes back to where it was.
TEST(WallSpring, StripesUnderASteadyPushLeadNowhere) {
  WallSpring sut = plain(kSoft);
  for (int i = 0; i < 1000; ++i) {
    sut.become(kHard, 0.01);
    sut.become(kSoft, 0.01);
  }
  EXPECT_NEAR(sut.gap_m(), 0, 1e-12);
  EXPECT_NEAR(sut.force_newton(0.01), 2, 1e-9);
}

TEST(WallSpring, SunkFeelsTheSameDeeper) {
  WallSpring sut = plain(kSoft);
  sut.become(kHard, 0.01);
  const double before_newton = sut.force_newton(0.012);
  sut.sink(5);
  EXPECT_NEAR(sut.force_newton(5.012), before_newton, 1e-9);
  EXPECT_EQ(sut.force_newton(4.99), 0);
}

TEST(WallSpring, DoesNotSinkByNothingOrBackwards) {
  WallSpring sut = plain(kSoft);
  sut.sink(-1);
  sut.sink(0);
  EXPECT_EQ(sut.gap_m(), 0);
}

TEST(WallSpring, ChangedWhereNothingIsFeltBeginsWhereItBegan) {
  WallSpring sut = plain(kSoft);
  sut.sink(0.1);
  sut.become(kHard, 0.05);
  EXPECT_EQ(sut.force_newton(0.1), 0);
  EXPECT_NEAR(sut.force_newton(0.101), 2, 1e-9);
}

TEST(WallSpring, WithoutStiffnessIsNoWall) {
  WallSpring sut = plain(kHard);
  sut.become({0}, 0.01);
  EXPECT_EQ(sut.force_newton(0.02), 0);
  sut.become(kHard, 0.02);
  EXPECT_GE(sut.force_newton(0.021), 0);
  EXPECT_LE(sut.energy_joule(0.021), 0.5 * 2000 * 0.021 * 0.021);
}

// The oracle keeps no curve: only the work that the finger did.
TEST(WallSpring, RandomChangesNeverKickNorGiveBackMoreThanTheyTook) {
  std::mt19937_64 random(190);
  std::uniform_real_distribution<double> stiffness(0, 3000);
  std::uniform_real_distribution<double> move_m(-0.0004, 0.0004);
  for (int program = 0; program < 200; ++program) {
    WallSpring sut = plain({stiffness(random)});
    double depth_m = 0;
    double taken_joule = 0;
    for (int step = 0; step < 2000; ++step) {
      const double before_newton = sut.force_newton(depth_m);
      const double before_joule = sut.energy_joule(depth_m);
      switch (random() % 8) {
        case 0:
          sut.become({stiffness(random)}, depth_m);
          break;
        case 1: {
          sut.sink(0.001);
          depth_m += 0.001;  // the face came nearer; the finger stayed
          break;
        }
        default: {
          const double next_m = std::max(0.0, depth_m + move_m(random));
          taken_joule += sut.energy_joule(next_m) - before_joule;
          const double mean_newton = (sut.force_newton(next_m) + before_newton) / 2;
          // The energy is that of the force: exact but for the corners within one step.
          ASSERT_NEAR(sut.energy_joule(next_m) - before_joule, mean_newton * (next_m - depth_m),
                      3000 * 0.0004 * 0.0004);
          depth_m = next_m;
          continue;
        }
      }
      ASSERT_LE(sut.force_newton(depth_m), before_newton + 1e-9);
      ASSERT_LE(sut.energy_joule(depth_m), before_joule + 1e-12);
      ASSERT_LE(sut.energy_joule(depth_m), taken_joule + 1e-9);
    }
    ASSERT_GE(taken_joule, -1e-9);
  }
}

}  // namespace
}  // namespace thimble::coupling
