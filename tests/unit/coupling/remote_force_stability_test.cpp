#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "daemon/coupling/remote_force_arm.hpp"
#include "daemon/coupling/remote_force_world.hpp"
#include "daemon/coupling/wall_penalty.hpp"
#include "fake_box.hpp"
#include "hand_mass.hpp"
#include "linked_loop.hpp"

namespace thimble::coupling {
namespace {

using testing::delayed_by;
using testing::FakeBox;
using testing::HandMass;
using testing::LinkedLoop;

constexpr double kMass_kg = 0.15;  // teleop.md 2(a)
constexpr double kCeiling_newton_per_m = kHardestTool.stiffness.newton_per_m;

// A box without an inside is a spring that pushes both ways: the linear case of the theory.
bool is_stable(double stiffness_newton_per_m, double damping_newton_s_per_m, Duration dt,
               double delay_s) {
  RemoteForceArm arm({.tool = {.stiffness = {stiffness_newton_per_m}, .damping = {0}}});
  FakeBox box(0);
  RemoteForceWorld world(box, 1);
  HandMass hand(kMass_kg, damping_newton_s_per_m, 0.001);
  LinkedLoop loop(arm, world, dt, delayed_by(delay_s));
  // The size of the swing early and late: what is stable shrinks. Both last many of its periods.
  std::array<double, 2> swing_m{};
  const auto ticks = static_cast<int>(6 / seconds(dt));
  for (int i = 0; i < ticks; ++i) {
    const ArmOutput out = loop.tick({hand.x_m, 0, 0}, {hand.v_m_per_s, 0, 0});
    hand.move(out.force.x, seconds(dt));
    if (std::abs(hand.x_m) > 1) return false;
    if (i > ticks / 3) {
      double& swing = swing_m[i > 2 * ticks / 3 ? 1 : 0];
      swing = std::max(swing, std::abs(hand.x_m));
    }
  }
  return swing_m[1] < swing_m[0];
}

double largest_stable_stiffness(double damping_newton_s_per_m, Duration dt, double delay_s) {
  double stable = 0;
  double unstable = kCeiling_newton_per_m;
  while (unstable - stable > 0.005 * unstable) {
    const double middle = (stable + unstable) / 2;
    (is_stable(middle, damping_newton_s_per_m, dt, delay_s) ? stable : unstable) = middle;
  }
  return stable;
}

// teleop.md 2(a): K < b/(Ts/2 + D) for B = 0, up to 20 ms.
TEST(RemoteForceStability, LargestStiffnessIsThatOfTheTheory) {
  constexpr Duration kServo = std::chrono::milliseconds(1);
  for (const double damping : {2.0, 4.0, 8.0}) {
    for (const int delay_ms : {1, 2, 5, 10, 20}) {
      // Beyond the ceiling no wall is harder.
      const double theory = std::min(damping / (0.0005 + 1e-3 * delay_ms), kCeiling_newton_per_m);
      const double measured = largest_stable_stiffness(damping, kServo, 1e-3 * delay_ms);
      EXPECT_NEAR(measured, theory, 0.15 * theory) << delay_ms << " ms, b = " << damping;
      RecordProperty("K_max_" + std::to_string(delay_ms) + "_ms_b_" +
                         std::to_string(static_cast<int>(damping)),
                     std::to_string(measured));
    }
  }
}

// Delays that are whole periods of each: a reply between two ticks waits for the second.
TEST(RemoteForceStability, LargestStiffnessIsThatOfTheTheoryAtAnyServoRate) {
  for (const int rate_hz : {500, 1000, 4000}) {
    for (const int delay_ms : {2, 10, 20}) {
      const Duration dt = std::chrono::microseconds(1'000'000 / rate_hz);
      const double theory = 4 / (seconds(dt) / 2 + 1e-3 * delay_ms);
      EXPECT_NEAR(largest_stable_stiffness(4, dt, 1e-3 * delay_ms), theory, 0.15 * theory)
          << rate_hz << " Hz, " << delay_ms << " ms";
    }
  }
}

// The thesis's wall at the delay of its Ethernet, thesis 3.2: "sometimes violent instabilities".
TEST(RemoteForceStability, TheWallOfTheThesisSwingsFromTwoMillisecondsOn) {
  constexpr Duration kServo = std::chrono::milliseconds(1);
  EXPECT_TRUE(is_stable(800, 2, kServo, 0.001));
  EXPECT_FALSE(is_stable(800, 2, kServo, 0.003));
}

}  // namespace
}  // namespace thimble::coupling
