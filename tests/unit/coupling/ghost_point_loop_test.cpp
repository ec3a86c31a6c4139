#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <vector>

#include "daemon/coupling/ghost_point_arm.hpp"
#include "daemon/world/voxel_world.hpp"
#include "delayed_loop.hpp"
#include "fake_box.hpp"
#include "turned_world.hpp"
#include "zone_hand.hpp"

namespace thimble::coupling {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using testing::DelayedLoop;
using testing::FakeBox;
using testing::Pace;

constexpr double kSpeed_m_per_s = 0.2;  // thesis table 4.1
constexpr double kReach_m = 0.0635;     // the arm's range, thesis 4.1
constexpr double kHysteresis_m = 0.0005;

// |o| right after the first shift when a kinematic hand goes from `start_m` at `speed` towards
// the wall at 15 mm; 0 when the wall was felt without one.
double first_offset_m(Duration delay, Pace pace, double start_m,
                      double speed_m_per_s = kSpeed_m_per_s) {
  GhostPointArm arm{GhostPointSettings{}};
  FakeBox box(0.015);
  DelayedLoop loop(arm, box, milliseconds(1), delay, pace);
  for (int i = 0; i < 3000; ++i) {
    const double x_m = std::min(start_m + speed_m_per_s * 1e-3 * i, kReach_m);
    const ArmOutput out = loop.tick({x_m, 0, 0}, {x_m < kReach_m ? speed_m_per_s : 0, 0, 0});
    if (out.offset.x != 0) return norm(out.offset);
    if (out.force.x < -2) return 0;
  }
  ADD_FAILURE() << "never touched";
  return 0;
}

// Mean over phases between the hand's arrival and the exchange, evenly spread.
double mean_offset_m(Duration delay, Pace pace, double speed_m_per_s = kSpeed_m_per_s) {
  constexpr int kPhases = 200;
  double sum_m = 0;
  for (int i = 0; i < kPhases; ++i) {
    const double cycle_m = speed_m_per_s * seconds(delay);
    const double start_m = 0.0137 - cycle_m * (i + 0.5) / kPhases;
    sum_m += first_offset_m(delay, pace, start_m, speed_m_per_s);
  }
  return sum_m / kPhases;
}

TEST(GhostPointLoop, StreamedOffsetIsSpeedTimesDelayLessHysteresis) {
  for (const int delay_ms : {20, 50, 100, 200}) {
    for (const double start_m : {0.0, 0.00007, -0.00011}) {
      const double least_m = kSpeed_m_per_s * delay_ms * 1e-3 - kHysteresis_m;
      const double offset_m = first_offset_m(milliseconds(delay_ms), Pace::Streamed, start_m);
      EXPECT_GE(offset_m, least_m - 1e-9) << delay_ms;
      EXPECT_LE(offset_m, least_m + kSpeed_m_per_s * 1e-3 + 1e-9) << delay_ms;
    }
  }
}

// teleop.md 4: column S, and the slope of its fit.
TEST(GhostPointLoop, ReproducesTable41Streamed) {
  const std::vector<std::pair<int, double>> table_mm{
      {1, 0}, {20, 3.7}, {50, 9.7}, {100, 19.7}, {200, 39.7}};
  for (const auto& [delay_ms, expected_mm] : table_mm) {
    const double got_mm = 1e3 * mean_offset_m(milliseconds(delay_ms), Pace::Streamed);
    EXPECT_NEAR(got_mm, expected_mm, 0.6) << delay_ms << " ms";
    RecordProperty("streamed_" + std::to_string(delay_ms) + "_ms", std::to_string(got_mm));
  }
  const double slope_m_per_s = (mean_offset_m(milliseconds(200), Pace::Streamed) -
                                mean_offset_m(milliseconds(20), Pace::Streamed)) /
                               0.18;
  EXPECT_NEAR(slope_m_per_s, 0.2, 0.005);
}

TEST(GhostPointLoop, LockStepOffsetLiesBetweenOneAndTwoDelays) {
  for (const int delay_ms : {20, 50, 100}) {
    for (int i = 0; i < 50; ++i) {
      const double start_m = 0.0137 - kSpeed_m_per_s * delay_ms * 1e-3 * i / 50;
      const double offset_m = first_offset_m(milliseconds(delay_ms), Pace::LockStep, start_m);
      const double unit_m = kSpeed_m_per_s * delay_ms * 1e-3;
      EXPECT_GE(offset_m, unit_m - kHysteresis_m - 1e-9);
      EXPECT_LE(offset_m, 2 * unit_m - kHysteresis_m + kSpeed_m_per_s * 1e-3);
    }
  }
}

TEST(GhostPointLoop, LockStepOffsetIsOneAndAHalfDelaysInTheMean) {
  for (const int delay_ms : {20, 50, 100}) {
    const double expected_m = 1.5 * kSpeed_m_per_s * delay_ms * 1e-3 - kHysteresis_m;
    const double got_m = mean_offset_m(milliseconds(delay_ms), Pace::LockStep);
    EXPECT_NEAR(got_m, expected_m, 0.03 * expected_m) << delay_ms << " ms";
  }
}

// The printed numbers come out at the slower hand that lock-step implies.
TEST(GhostPointLoop, LockStepReproducesThePrintedTableAtASlowerHand) {
  const std::vector<std::pair<int, double>> printed_mm{{20, 4}, {50, 12}, {100, 23}};
  for (const auto& [delay_ms, expected_mm] : printed_mm) {
    const double got_mm = 1e3 * mean_offset_m(milliseconds(delay_ms), Pace::LockStep, 0.155);
    EXPECT_NEAR(got_mm, expected_mm, 1.5) << delay_ms << " ms";
  }
}

TEST(GhostPointLoop, HalfASecondOfDelaySaturatesAtTheReachOfTheArm) {
  EXPECT_NEAR(first_offset_m(milliseconds(500), Pace::Streamed, 0), 0.048, 1e-9);
}

// A hand that wanders in three axes and meets walls now on one, now on another.
Position3 wander(double t_s) {
  return {0.028 * std::sin(2.1 * t_s), 0.022 * std::sin(1.3 * t_s + 1),
          0.019 * std::sin(0.7 * t_s + 2)};
}
Velocity3 wander_speed(double t_s) {
  return {0.028 * 2.1 * std::cos(2.1 * t_s), 0.022 * 1.3 * std::cos(1.3 * t_s + 1),
          0.019 * 0.7 * std::cos(0.7 * t_s + 2)};
}

TEST(GhostPointLoop, RateOfTheServoChangesNothing) {
  struct Trace {
    std::vector<Displacement3> offset;
    Force3 impulse{};
    std::uint32_t contacts{0};
  };
  const auto run = [](Duration dt) {
    GhostPointArm arm{GhostPointSettings{}};
    FakeBox box(0.015);
    DelayedLoop loop(arm, box, dt, milliseconds(40));
    Trace trace;
    for (Duration t{}; t < std::chrono::seconds(12); t += dt) {
      const ArmOutput out = loop.tick(wander(seconds(t)), wander_speed(seconds(t)));
      trace.impulse += seconds(dt) * out.force;
      trace.contacts += out.new_contacts;
      if (t % milliseconds(100) == Duration::zero()) trace.offset.push_back(out.offset);
    }
    return trace;
  };
  const Trace reference = run(microseconds(125));
  EXPECT_GT(reference.contacts, 5U);
  for (const int period_us : {250, 500, 1000, 2000}) {
    const Trace trace = run(microseconds(period_us));
    ASSERT_EQ(trace.offset.size(), reference.offset.size());
    for (std::size_t i = 0; i < trace.offset.size(); ++i) {
      EXPECT_LT(norm(trace.offset[i] - reference.offset[i]), 0.0003) << period_us << " us, " << i;
    }
    EXPECT_LT(norm(trace.impulse - reference.impulse), 0.02 * norm(reference.impulse));
    EXPECT_EQ(trace.contacts, reference.contacts);
  }
}

testing::TurnedTrace feel_turned(world::World& world, const world::Symmetry& turn) {
  GhostPointArm arm{GhostPointSettings{}};
  DelayedLoop loop(arm, world, milliseconds(1), milliseconds(30));
  testing::TurnedTrace trace;
  for (int i = 0; i < 6000; ++i) {
    const Position3 tip = testing::about(1e-3 * i);
    const Velocity3 velocity = testing::about_speed(1e-3 * i);
    trace.emplace_back(turn, loop.tick(image(turn, tip), image(turn, velocity)));
  }
  EXPECT_GT(testing::ticks_felt(trace), 1000);
  return trace;
}

// Defects 1 and 27: all six faces are alike, to the last bit; so are walls of any angle.
TEST(GhostPointLoop, MirroredAndPermutedWorldsGiveMirroredAndPermutedForces) {
  FakeBox box(0.015);
  testing::expect_turned_is_felt_turned(box, feel_turned, 0);
  world::SphereWorld ball = testing::make_ball();
  testing::expect_turned_is_felt_turned(ball, feel_turned, 1e-6);
}

// The same where the world turns its own cells.
TEST(GhostPointLoop, MirroredAndPermutedCellsGiveMirroredAndPermutedForces) {
  std::mt19937_64 random(613);
  for (int run = 0; run < 4; ++run) {
    world::VoxelGrid grid = testing::cells_at_random(random, 0.012);
    grid.set_occupied({4, 4, 3}, false);
    testing::expect_turned_cells_are_felt_turned(
        grid,
        [](const world::VoxelGrid& cells, const world::Symmetry& turn) {
          world::VoxelWorld world(cells, "cells");
          return feel_turned(world, turn);
        },
        0);
  }
}

// The box of the thesis, cut into voxels, feels like the plainest box there is.
TEST(GhostPointLoop, VoxelBoxFeelsLikeAPlainBox) {
  FakeBox plain(0.015);
  for (const std::uint32_t cells : {3U, 12U}) {
    world::VoxelWorld voxels(world::make_box(cells).value(), "box");
    GhostPointArm plain_arm{GhostPointSettings{}};
    GhostPointArm voxel_arm{GhostPointSettings{}};
    DelayedLoop plain_loop(plain_arm, plain, milliseconds(1), milliseconds(30));
    DelayedLoop voxel_loop(voxel_arm, voxels, milliseconds(1), milliseconds(30));
    double hardest_newton = 0;
    for (int i = 0; i < 10'000; ++i) {
      const Position3 tip = wander(1e-3 * i);
      const Velocity3 velocity = wander_speed(1e-3 * i);
      const ArmOutput expected = plain_loop.tick(tip, velocity);
      const ArmOutput got = voxel_loop.tick(tip, velocity);
      ASSERT_LT(norm(got.force - expected.force), 1e-6) << cells << " cells, tick " << i;
      ASSERT_LT(norm(got.offset - expected.offset), 1e-9) << cells << " cells, tick " << i;
      hardest_newton = std::max(hardest_newton, norm(got.force));
    }
    EXPECT_GT(hardest_newton, 0.4);
  }
}

// Repeated taps on one face: the frame drifts, the drift is bounded by relaxation.
TEST(GhostPointLoop, SlowTapsDoNotDriveTheFrameAway) {
  GhostPointArm arm{GhostPointSettings{}};
  FakeBox box(0.015);
  DelayedLoop loop(arm, box, milliseconds(1), milliseconds(50));
  double largest_m = 0;
  for (int i = 0; i < 60'000; ++i) {
    const double phase = std::fmod(1e-3 * i, 1.0);  // one tap a second, 15 mm free travel
    const double depth_m = phase < 0.15 ? 0.2 * phase : 0.2 * std::max(0.0, 0.3 - phase);
    const double v_m_per_s = phase < 0.15 ? 0.2 : phase < 0.3 ? -0.2 : 0;
    const ArmOutput out = loop.tick({0.005 + depth_m, 0, 0}, {v_m_per_s, 0, 0});
    largest_m = std::max(largest_m, norm(out.offset));
  }
  EXPECT_GT(largest_m, 0.009);
  EXPECT_LT(largest_m, 0.020);
}

}  // namespace
}  // namespace thimble::coupling
