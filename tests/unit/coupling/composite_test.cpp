#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <utility>
#include <vector>

#include "composed.hpp"
#include "daemon/coupling/ghost_point_world.hpp"
#include "hand_samples.hpp"
#include "turned_world.hpp"
#include "zone_hand.hpp"

namespace thimble::coupling {
namespace {

using testing::between;
using testing::cells_at_random;
using testing::Composed;
using testing::delayed_by;
using testing::in_cells_of;
using testing::kTick;
using testing::middle_of;
using testing::room_at_random;
using testing::UndelayedGhostPoint;
using testing::ZoneHand;
using world::Cell;
using world::VoxelGrid;
using world::VoxelWorld;

struct MapCourse {
  VoxelGrid grid;
  Cell start{};
  double most_m_per_s{0.3};
  double rest_s{0};
  int rate_hz{1000};
  link::ImpairmentSettings link{};
};

struct BesideUndelayed {
  int ticks_felt{0};
  int ticks_that_differ{0};
  std::uint64_t corrections{0};
};

// The same hand on the scheme and without any delay.
BesideUndelayed beside_undelayed(const MapCourse& course, std::uint64_t seed) {
  const Duration dt = from_seconds(1.0 / course.rate_hz);
  Composed sut(course.grid, dt, course.link);
  const Position3 start = middle_of(course.grid, course.start);
  UndelayedGhostPoint undelayed(course.grid, start, course.start);
  ZoneHand hand(seed, start, course.most_m_per_s);
  (void)sut.rest(start, course.rest_s);
  BesideUndelayed out;
  for (double t = 0; t < 3; t += seconds(dt)) {
    hand.move(undelayed.ghost(), dt);
    const ArmOutput expected = undelayed.tick(hand.at(), hand.velocity(), dt);
    const ArmOutput felt = sut.loop.tick(hand.at(), hand.velocity());
    if (expected.force != Force3{}) ++out.ticks_felt;
    if (felt.force != expected.force || felt.offset != expected.offset) ++out.ticks_that_differ;
  }
  out.corrections = sut.arm.counters().corrections;
  return out;
}

TEST(Composite, AWorldThatStaysIsFeltAsWithoutDelayBitForBit) {
  std::mt19937_64 random(720);
  int felt = 0;
  for (std::uint64_t run = 0; run < 60; ++run) {
    MapCourse course{.grid = cells_at_random(random, between(random, 0.02, 0.04)),
                     .start = {4, 4, 3}};
    const double delay_s = between(random, 0, 0.5);
    course.rate_hz = std::array{500, 1000, 2000, 4000}[run % 4];
    course.link = delayed_by(delay_s);
    course.rest_s = delay_s + 0.2;
    const BesideUndelayed found = beside_undelayed(course, run);
    EXPECT_EQ(found.ticks_that_differ, 0) << run;
    EXPECT_EQ(found.corrections, 0U) << run;
    felt += found.ticks_felt;
  }
  EXPECT_GT(felt, 50'000);
}

TEST(Composite, SoItIsInARoomUnderJitterLossAndReordering) {
  std::mt19937_64 random(721);
  int felt = 0;
  for (std::uint64_t run = 0; run < 40; ++run) {
    MapCourse course{.grid = room_at_random(random, between(random, 0.003, 0.01)),
                     .start = {5, 5, 5},
                     .most_m_per_s = 0.2};
    const double delay_s = between(random, 0, 0.3);
    course.rate_hz = std::array{1000, 2000, 4000}[run % 3];
    course.link = {.delay_s = delay_s,
                   .jitter_s = delay_s / 4,
                   .loss = 0.05,
                   .duplicate = 0.02,
                   .reorder = 0.02,
                   .seed = run};
    course.rest_s = 3 * delay_s + 0.5;
    const BesideUndelayed found = beside_undelayed(course, run);
    EXPECT_EQ(found.ticks_that_differ, 0) << run;
    felt += found.ticks_felt;
  }
  EXPECT_GT(felt, 50'000);
}

// Whatever the network did to the way that the world's ghost took, once the hand rests both agree.
TEST(Composite, TheGhostsOfBothHalvesComeTogetherWhereverTheyParted) {
  std::mt19937_64 random(722);
  std::uint64_t corrections = 0;
  for (std::uint64_t run = 0; run < 60; ++run) {
    const VoxelGrid grid = cells_at_random(random, 0.004);
    const double delay_s = between(random, 0.02, 0.2);
    Composed sut(
        grid, kTick,
        {.delay_s = delay_s, .jitter_s = delay_s / 2, .loss = 0.4, .reorder = 0.05, .seed = run});
    const Position3 start = middle_of(grid, {4, 4, 3});
    (void)sut.rest(start, 1);
    Position3 tip = start;
    Position3 goal = start;
    for (int i = 0; i < 1500; ++i) {
      if (norm(goal - tip) < 0.002) {
        goal = {between(random, -0.02, 0.02), between(random, -0.02, 0.02),
                between(random, -0.02, 0.02)};
      }
      tip = tip + 0.0015 / std::max(0.0015, norm(goal - tip)) * (goal - tip);
      (void)sut.loop.tick(tip, {});
    }
    const ArmOutput out = sut.rest(tip, 3 * delay_s + 1);
    ASSERT_TRUE(out.sample.has_ghost) << run;
    HandSample asked = out.sample;
    asked.sequence += 1'000'000;
    EXPECT_EQ(sut.world.answer(asked, kTick).ghost, out.sample.ghost) << run;
    corrections += sut.arm.counters().corrections;
  }
  EXPECT_GT(corrections, 50U) << "they did part";
}

// In `turned`, whose cells come and go; `grid` is what it is the image of.
testing::TurnedTrace feel_turned(const VoxelGrid& grid, const VoxelGrid& turned,
                                 const world::Symmetry& turn, std::uint64_t seed) {
  Composed sut(turned, kTick, delayed_by(0.08));
  (void)sut.rest({}, 0.4);
  ZoneHand hand(seed, {}, 0.4);
  UndelayedGhostPoint person(grid, {}, testing::kCellOfTheOrigin);
  std::mt19937_64 random(seed);
  testing::TurnedTrace trace;
  for (int i = 0; i < 2000; ++i) {
    if (i % 100 == 99) {
      Cell cell;
      for (std::size_t a = 0; a < 3; ++a) {
        cell[a] = static_cast<std::int32_t>(random() % grid.cells()[a]);
      }
      sut.cells.set_cell(image(turn, grid, cell), random() % 2 == 0);
    }
    hand.move(person.ghost(), kTick);
    (void)person.tick(hand.at(), hand.velocity(), kTick);
    trace.emplace_back(turn, sut.loop.tick(image(turn, hand.at()), image(turn, hand.velocity())));
  }
  EXPECT_GT(testing::ticks_felt(trace), 100);
  return trace;
}

TEST(Composite, MirroredAndPermutedWorldsGiveMirroredAndPermutedForces) {
  std::mt19937_64 random(723);
  for (std::uint64_t run = 0; run < 4; ++run) {
    const VoxelGrid grid = testing::cells_round_the_origin(random);
    testing::expect_turned_cells_are_felt_turned(
        grid,
        [&](const VoxelGrid& turned, const world::Symmetry& turn) {
          return feel_turned(grid, turned, turn, run);
        },
        1e-6);
  }
}

// Takes what the answers tell of cells out of them.
class WithoutMap final : public WorldCoupling {
 public:
  explicit WithoutMap(WorldCoupling& inside) : inside_(inside) {}
  [[nodiscard]] Result<void> open(const HandSample& first) override { return inside_.open(first); }
  [[nodiscard]] ConstraintSet answer(const HandSample& sample, Duration dt) noexcept override {
    ConstraintSet set = inside_.answer(sample, dt);
    set.has_map = false;
    return set;
  }
  void close() noexcept override { inside_.close(); }

 private:
  WorldCoupling& inside_;
};

TEST(Composite, WhatIsNotKnownIsFeltAsByTheGhostPoint) {
  std::mt19937_64 random(724);
  int felt = 0;
  for (std::uint64_t run = 0; run < 30; ++run) {
    const VoxelGrid grid = cells_at_random(random, 0.02);
    const Position3 start = middle_of(grid, {4, 4, 3});
    const link::ImpairmentSettings link = delayed_by(between(random, 0, 0.1));
    VoxelWorld cells(grid, "cells");
    CompositeWorld told(cells, 1);
    WithoutMap world(told);
    CompositeArm arm(testing::in_cells_of(0.02));
    testing::LinkedLoop sut(arm, world, kTick, link);
    VoxelWorld other_cells(grid, "cells");
    GhostPointWorld other_world(other_cells, 1);
    GhostPointArm other_arm(testing::in_cells_of(0.02));
    testing::LinkedLoop reference(other_arm, other_world, kTick, link);
    UndelayedGhostPoint person(grid, start, {4, 4, 3});
    ZoneHand hand(run, start, 0.3);
    for (int i = 0; i < 2000; ++i) {
      hand.move(person.ghost(), kTick);
      (void)person.tick(hand.at(), hand.velocity(), kTick);
      const ArmOutput found = sut.tick(hand.at(), hand.velocity());
      const ArmOutput expected = reference.tick(hand.at(), hand.velocity());
      ASSERT_EQ(found.force, expected.force) << run << " " << i;
      ASSERT_EQ(found.offset, expected.offset);
      if (found.force != Force3{}) ++felt;
    }
    EXPECT_EQ(arm.counters().trusted, 2000U);
  }
  EXPECT_GT(felt, 5000);
}

PlaneList planes_at_random(std::mt19937_64& random) {
  PlaneList planes;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (random() % 2 == 0) continue;
    ConstraintPlane plane;
    plane.normal[axis] = random() % 2 == 0 ? 1 : -1;
    plane.offset_m = between(random, -0.02, 0.02);
    if (random() % 2 == 0) plane.surface = {{between(random, 100, 900)}, {1}, 0.3};
    planes.push_back(plane);
  }
  return planes;
}

// What an arm relies on that leaves the scheme to the world.
TEST(Composite, WithoutAMapItIsTheGhostPointBitForBit) {
  std::mt19937_64 random(727);
  int felt = 0;
  for (std::uint64_t run = 0; run < 20; ++run) {
    CompositeArm sut(in_cells_of(0.003));
    GhostPointArm expected(in_cells_of(0.003));
    ConstraintSet set{.session = 1};
    ArmInput input{.dt = kTick, .link = {true, kTick, {}}};
    for (int tick = 0; tick < 3000; ++tick) {
      input.now = input.now + input.dt;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        input.tip_velocity[axis] += between(random, -0.02, 0.02) - 2 * input.tip[axis];
        input.tip[axis] += 1e-3 * input.tip_velocity[axis];
      }
      const bool is_outage = tick % 1500 > 1000;
      const bool is_fresh = !is_outage && random() % 3 != 0;
      if (is_fresh) ++set.sequence;
      if (is_fresh && random() % 20 == 0) set.planes = planes_at_random(random);
      if (random() % 1000 == 0) set = {.session = set.session + 1};
      input.fresh = is_fresh ? &set : nullptr;
      if (random() % 700 == 0) {
        sut.reset(input.now, input.tip);
        expected.reset(input.now, input.tip);
      }
      const ArmOutput is = sut.step(input);
      const ArmOutput ought = expected.step(input);
      ASSERT_EQ(is.force, ought.force) << run << ", " << tick;
      ASSERT_EQ(is.offset, ought.offset);
      ASSERT_EQ(is.sample.hand, ought.sample.hand);
      ASSERT_FALSE(is.sample.has_ghost);
      ASSERT_EQ(is.is_frozen, ought.is_frozen);
      ASSERT_EQ(is.is_fading, ought.is_fading);
      if (is.force != Force3{}) ++felt;
    }
  }
  EXPECT_GT(felt, 10'000);
}

}  // namespace
}  // namespace thimble::coupling
