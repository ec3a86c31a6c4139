#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <string>
#include <vector>

#include "daemon/coupling/constraint_plane_arm.hpp"
#include "daemon/world/sphere_world.hpp"
#include "hand_on_arm.hpp"
#include "turned_world.hpp"

namespace thimble::coupling {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using testing::about;
using testing::about_speed;
using testing::DelayedLoop;
using testing::FakeBox;
using testing::HandOnArm;
using testing::make_ball;
using testing::Pace;
using testing::Reference;
using testing::TurnedTrace;

struct Pushed {
  double held_newton{0};
  double swing_m{0};  // peak to peak while the hand holds
  double peak_newton{0};
  double generated_joule{0};
  std::uint64_t news{0};
};

Pushed push(LateWalls late_walls, int delay_ms) {
  ConstraintPlaneSettings settings;
  settings.late_walls = late_walls;
  ConstraintPlaneArm arm(settings);
  HandOnArm hand(arm, milliseconds(delay_ms), Pace::Streamed, -0.015);
  Pushed out;
  double least_m = 1;
  double most_m = -1;
  Reference reference;
  for (int tick = 0; tick < Reference::kTicks; ++tick) {
    reference.advance(tick);
    const ArmOutput got = hand.tick(reference.x_m, reference.v_m_per_s);
    out.peak_newton = std::max(out.peak_newton, -got.force.x);
    if (tick < Reference::kHoldFrom_tick || tick >= Reference::kHoldTo_tick) continue;
    out.held_newton = -got.force.x;
    least_m = std::min(least_m, hand.x_m());
    most_m = std::max(most_m, hand.x_m());
  }
  out.swing_m = most_m - least_m;
  out.generated_joule = hand.energy().generated_joule();
  out.news = arm.counters().news;
  return out;
}

constexpr std::array kDelays_ms{1, 2, 5, 10, 20, 50, 100, 200, 500};

// teleop.md 5, gates G1, G2 and G4; at most ½·K·H² for each plane that is news.
TEST(ConstraintPlaneLoop, AnOffsetHandHoldsStillAndIsGivenNothingAtAnyDelay) {
  for (const int delay_ms : kDelays_ms) {
    const Pushed got = push(LateWalls::Offset, delay_ms);
    EXPECT_LT(got.swing_m, 0.0005) << delay_ms;
    EXPECT_LT(got.peak_newton, 8.5) << delay_ms;
    EXPECT_LE(got.generated_joule, static_cast<double>(got.news) * 0.5 * 800 * 0.0005 * 0.0005)
        << delay_ms;
    RecordProperty("offset_hold_" + std::to_string(delay_ms) + "_ms_newton",
                   std::to_string(got.held_newton));
  }
}

// teleop.md 3, the last row: walls at their true place hold as if there were no delay, and their
// way there gives the hand energy: 4 mJ at 20 ms, 41 at 500.
TEST(ConstraintPlaneLoop, ARecoveredWallHoldsAsWithoutDelayAndInjects) {
  for (const int delay_ms : kDelays_ms) {
    const Pushed got = push(LateWalls::Recovery, delay_ms);
    EXPECT_LT(got.swing_m, 0.0005) << delay_ms;
    EXPECT_NEAR(got.held_newton, 3.2, 0.1) << delay_ms;
    EXPECT_LE(got.generated_joule, 0.05) << delay_ms;
    RecordProperty("recovery_" + std::to_string(delay_ms) + "_ms_millijoule",
                   std::to_string(1e3 * got.generated_joule));
  }
  EXPECT_GT(push(LateWalls::Recovery, 200).generated_joule, 0.01) << "it does inject";
}

TurnedTrace feel_turned(world::World& world, const world::Symmetry& turn, LateWalls late_walls) {
  ConstraintPlaneSettings settings;
  settings.late_walls = late_walls;
  ConstraintPlaneArm arm(settings);
  DelayedLoop loop(arm, world, milliseconds(1), milliseconds(30));
  TurnedTrace trace;
  for (int i = 0; i < 12'000; ++i) {
    const Velocity3 velocity = about_speed(1e-3 * i);
    trace.emplace_back(turn, loop.tick(image(turn, about(1e-3 * i)), image(turn, velocity)));
  }
  EXPECT_GT(testing::ticks_felt(trace), 1000);
  return trace;
}

TEST(ConstraintPlaneLoop, MirroredAndPermutedWorldsGiveMirroredAndPermutedForces) {
  for (const LateWalls late_walls : {LateWalls::Offset, LateWalls::Recovery}) {
    world::SphereWorld ball = make_ball();
    testing::expect_turned_is_felt_turned(
        ball,
        [&](world::World& world, const world::Symmetry& turn) {
          return feel_turned(world, turn, late_walls);
        },
        1e-6);
  }
}

// 500 Hz to 8 kHz, in the plainest box: edges and corners of three walls.
TEST(ConstraintPlaneLoop, RateOfTheServoChangesNothing) {
  struct Trace {
    std::vector<Displacement3> offset;
    Force3 impulse{};
  };
  const auto run = [](Duration dt, LateWalls late_walls) {
    ConstraintPlaneSettings settings;
    settings.late_walls = late_walls;
    ConstraintPlaneArm arm(settings);
    FakeBox box(0.015);
    DelayedLoop loop(arm, box, dt, milliseconds(40));
    Trace trace;
    for (Duration t{}; t < std::chrono::seconds(12); t += dt) {
      const ArmOutput out = loop.tick(about(seconds(t)), about_speed(seconds(t)));
      trace.impulse += seconds(dt) * out.force;
      if (t % milliseconds(100) == Duration::zero()) trace.offset.push_back(out.offset);
    }
    return trace;
  };
  for (const LateWalls late_walls : {LateWalls::Offset, LateWalls::Recovery}) {
    const Trace reference = run(microseconds(125), late_walls);
    EXPECT_GT(norm(reference.impulse), 1);
    for (const int period_us : {250, 500, 1000, 2000}) {
      const Trace trace = run(microseconds(period_us), late_walls);
      ASSERT_EQ(trace.offset.size(), reference.offset.size());
      for (std::size_t i = 0; i < trace.offset.size(); ++i) {
        EXPECT_LT(norm(trace.offset[i] - reference.offset[i]), 0.0004) << period_us << " us, " << i;
      }
      EXPECT_LT(norm(trace.impulse - reference.impulse), 0.02 * norm(reference.impulse));
    }
  }
}

}  // namespace
}  // namespace thimble::coupling
