#include <gtest/gtest.h>

#include "arm_bench.hpp"

namespace thimble::coupling {
namespace {

using testing::ArmBench;
using testing::kPlusX;
using testing::wall;
using testing::without_spring;

constexpr Position3 kPressed{0.018, 0, 0};

// Presses a known wall 3 mm deep.
ArmOutput press(ArmBench& bench) {
  bench.told({0.010, 0, 0}, {wall(kPlusX, 0.015)});
  return bench.told(kPressed, {wall(kPlusX, 0.015)});
}

// Defect 2: silence of the peer.
TEST(GhostPointSilence, FrameIsFrozenWhileRepliesAreOverdue) {
  ArmBench bench;
  bench.told({-0.030, 0, 0}, {wall({-1, 0, 0}, 0.015)});
  bench.told({}, {});
  for (int i = 0; i < 20; ++i) bench.alone({});
  const ArmOutput frozen = bench.alone({});
  EXPECT_TRUE(frozen.is_frozen);
  EXPECT_EQ(bench.alone({}).offset, frozen.offset);
  EXPECT_LT(norm(bench.told({}, {}).offset), norm(frozen.offset));
}

TEST(GhostPointSilence, WallFadesThenIsForgotten) {
  ArmBench bench(without_spring());
  press(bench);
  double last_newton = 2.4;
  ArmOutput out{};
  for (int i = 0; i < 360; ++i) {
    out = bench.alone(kPressed);
    EXPECT_LE(-out.force.x, last_newton + 1e-12);
    EXPECT_GT(-out.force.x, last_newton - 0.025);
    last_newton = -out.force.x;
  }
  EXPECT_EQ(out.force, Force3{});
  EXPECT_TRUE(out.is_fading);
  EXPECT_FALSE(out.is_in_contact);
}

TEST(GhostPointSilence, ReturningWallIsLearnedAnewAndRampsUp) {
  ArmBench bench(without_spring());
  press(bench);
  for (int i = 0; i < 400; ++i) bench.alone(kPressed);
  double last_newton = 0;
  ArmOutput out{};
  for (int i = 0; i < 120; ++i) {
    out = bench.told({0.040, 0, 0}, {wall(kPlusX, 0.015)});
    EXPECT_LE(-out.force.x, last_newton + 0.005);
    last_newton = -out.force.x;
  }
  EXPECT_NEAR(out.sample.hand.x, 0.0155, 1e-9);
  EXPECT_NEAR(out.force.x, -0.4, 1e-9);
}

TEST(GhostPointSilence, ReturnInTheMiddleOfAFadeGivesNoKick) {
  ArmBench bench(without_spring());
  press(bench);
  ArmOutput out{};
  for (int i = 0; i < 320; ++i) out = bench.alone({0.040, 0, 0});
  double last_newton = -out.force.x;
  EXPECT_GT(last_newton, 4);
  for (int i = 0; i < 120; ++i) {
    out = bench.told({0.040, 0, 0}, {wall(kPlusX, 0.015)});
    EXPECT_LE(-out.force.x, last_newton + 0.1);
    last_newton = -out.force.x;
  }
  EXPECT_LE(last_newton, 800 * 0.025 * 0.35);
}

TEST(GhostPointSilence, LooserTimesCanBeConfigured) {
  GhostPointSettings settings;
  settings.age.fade_floor = std::chrono::seconds(2);
  ArmBench bench(settings);
  press(bench);
  ArmOutput out{};
  for (int i = 0; i < 1900; ++i) out = bench.alone(kPressed);
  EXPECT_FALSE(out.is_fading);
  EXPECT_LT(out.force.x, -2.3);
}

}  // namespace
}  // namespace thimble::coupling
