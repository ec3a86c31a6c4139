#include "sim/model/hand/hand_path.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/time/trace_hash.hpp"

namespace thimble::sim {
namespace {

constexpr Duration kStep{500'000};
constexpr double kStepSeconds = 500e-6;

HandSettings settings_of(HandMotion motion, std::uint64_t seed = 1) {
  HandSettings settings;
  settings.motion = motion;
  settings.seed = seed;
  return settings;
}

std::vector<PathPoint> play(const HandSettings& settings, double seconds_to_play) {
  HandPath sut(settings);
  std::vector<PathPoint> path;
  for (double t = 0; t < seconds_to_play; t += kStepSeconds) path.push_back(sut.advance(kStep));
  return path;
}

class HandPathOf : public testing::TestWithParam<HandMotion> {};
INSTANTIATE_TEST_SUITE_P(Motions, HandPathOf, testing::ValuesIn(kHandMotions),
                         [](const auto& of) { return std::string(to_string(of.param)); });

TEST_P(HandPathOf, StartsAtTheOriginAtRest) {
  const PathPoint first = play(settings_of(GetParam()), kStepSeconds).front();

  EXPECT_LT(norm(first.position - Position3{}), 1e-5);
  EXPECT_LT(norm(first.velocity), 0.01);
}

TEST_P(HandPathOf, MovesSmoothlyAndNeverFasterThanAskedFor) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const HandSettings settings = settings_of(GetParam(), seed);
    const double limit = GetParam() == HandMotion::Sweep ? 0.2 : settings.speed_m_per_s;
    const std::vector<PathPoint> path = play(settings, 25);
    for (std::size_t i = 1; i < path.size(); ++i) {
      const PathPoint& before = path[i - 1];
      const PathPoint& now = path[i];
      ASSERT_LE(norm(now.velocity), limit + 1e-9);
      ASSERT_LE(norm(now.velocity - before.velocity), 5 * kStepSeconds) << "m/s in a step";
      const Velocity3 mean = 0.5 * (now.velocity + before.velocity);
      const Displacement3 moved = now.position - before.position;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        ASSERT_NEAR(moved[axis], mean[axis] * kStepSeconds, 1e-6);
      }
    }
  }
}

TEST_P(HandPathOf, StaysWithinItsReach) {
  const double reach = GetParam() == HandMotion::Sweep ? 0.045 : 0.018;
  for (const PathPoint& point : play(settings_of(GetParam()), 25)) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      ASSERT_LE(std::abs(point.position[axis]), reach + 1e-9);
    }
  }
}

TEST_P(HandPathOf, FollowsItsSeedAlone) {
  const auto hash = [&](std::uint64_t seed) {
    TraceHash trace;
    for (const PathPoint& point : play(settings_of(GetParam(), seed), 3)) {
      for (std::size_t axis = 0; axis < 3; ++axis) trace.add(point.position[axis]);
    }
    return trace.value();
  };
  const bool is_seeded = GetParam() == HandMotion::Explore || GetParam() == HandMotion::Tremor;

  EXPECT_EQ(hash(4), hash(4));
  EXPECT_EQ(hash(4) != hash(5), is_seeded);
}

double nearest(const std::vector<PathPoint>& path, const auto& distance) {
  double least = 1;
  for (const PathPoint& point : path) least = std::min(least, distance(point.position));
  return least;
}

TEST(HandPath, ExploreVisitsEveryFaceAndCornerInEachRound) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const std::vector<PathPoint> path = play(settings_of(HandMotion::Explore, seed), 14 * 0.85);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const double side : {-0.018, 0.018}) {
        const auto to_face = [&](Position3 p) { return std::abs(p[axis] - side); };
        EXPECT_LT(nearest(path, to_face), 1e-4) << seed << ' ' << axis << ' ' << side;
      }
    }
    for (unsigned corner = 0; corner < 8; ++corner) {
      const Position3 target{(corner & 1U) != 0 ? 0.018 : -0.018,
                             (corner & 2U) != 0 ? 0.018 : -0.018,
                             (corner & 4U) != 0 ? 0.018 : -0.018};
      const auto to_corner = [&](Position3 p) { return norm(p - target); };
      EXPECT_LT(nearest(path, to_corner), 1e-4) << seed << ' ' << corner;
    }
  }
}

TEST(HandPath, PokePressesOnItsAxisOnlyAndReturns) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    HandSettings settings = settings_of(HandMotion::Poke);
    settings.axis = axis;
    int presses = 0;
    bool is_out = false;
    for (const PathPoint& point : play(settings, 10)) {
      for (std::size_t other = 0; other < 3; ++other) {
        if (other != axis) {
          ASSERT_EQ(point.position[other], 0);
        }
      }
      ASSERT_GE(point.position[axis], 0);
      if (!is_out && point.position[axis] > 0.0179) ++presses;
      if (point.position[axis] > 0.0179) is_out = true;
      if (point.position[axis] < 1e-4) is_out = false;
    }
    EXPECT_GE(presses, 8);
  }
}

TEST(HandPath, SweepRunsAtItsSpeedFromEndToEnd) {
  const std::vector<PathPoint> path = play(settings_of(HandMotion::Sweep), 20);
  std::size_t at_speed = 0;
  double low = 0, high = 0;
  for (const PathPoint& point : path) {
    if (std::abs(std::abs(point.velocity.x) - 0.2) < 1e-9) ++at_speed;
    low = std::min(low, point.position.x);
    high = std::max(high, point.position.x);
  }
  EXPECT_NEAR(low, -0.045, 1e-4);
  EXPECT_NEAR(high, 0.045, 1e-4);
  EXPECT_GT(at_speed, path.size() * 3 / 4);
}

TEST(HandPath, CirclePressesOnFourWallsInTurn) {
  std::vector<int> walls;  // 0 +x, 1 +y, 2 -x, 3 -y
  for (const PathPoint& point : play(settings_of(HandMotion::Circle), 5)) {
    const Position3 p = point.position;
    const int wall = p.x > 0.015 ? 0 : p.y > 0.015 ? 1 : p.x < -0.015 ? 2 : p.y < -0.015 ? 3 : -1;
    if (wall >= 0 && (walls.empty() || walls.back() != wall)) walls.push_back(wall);
  }
  ASSERT_GE(walls.size(), 16U);
  for (std::size_t i = 0; i < walls.size(); ++i) EXPECT_EQ(walls[i], static_cast<int>(i % 4));
}

TEST(HandPath, TremblesAtEightToTwelveHertz) {
  const std::vector<PathPoint> path = play(settings_of(HandMotion::Tremor), 21);
  int turns = 0;
  double last = 0;
  for (std::size_t i = 2001; i < path.size(); ++i) {  // once it has faded in
    const double acceleration = path[i].velocity.x - path[i - 1].velocity.x;
    if (acceleration * last < 0) ++turns;
    last = acceleration;
  }
  EXPECT_GT(turns / 2.0 / 20, 8);
  EXPECT_LT(turns / 2.0 / 20, 12);
}

TEST(Stroke, ArrivesExactlyFromRestToRest) {
  for (const double length : {0.0, 1e-6, 0.003, 0.05, 0.4}) {
    const Stroke sut({0.01, 0, 0}, {0.01, 0.6 * length, -0.8 * length}, 0.15);
    EXPECT_EQ(sut.at(-1).position, (Position3{0.01, 0, 0}));
    EXPECT_EQ(sut.at(sut.duration_s()).position, sut.end());
    EXPECT_LT(norm(sut.at(sut.duration_s() - 1e-9).velocity), 1e-8);
    EXPECT_LT(norm(sut.at(sut.duration_s() - 1e-9).position - sut.end()), 1e-12);
  }
}

}  // namespace
}  // namespace thimble::sim
