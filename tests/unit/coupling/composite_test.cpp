#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <utility>
#include <vector>

#include "composed.hpp"
#include "daemon/coupling/ghost_point_world.hpp"
#include "hand_samples.hpp"
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

using Rows = std::vector<std::array<double, 6>>;

// Force and offset of a hand in `grid`, whose cells come and go, turned back again.
Rows turned_trace(const VoxelGrid& grid, std::size_t shift, bool is_mirrored, std::uint64_t seed) {
  const auto turned = [&](Cell c) {
    Cell to;
    for (std::size_t a = 0; a < 3; ++a) to[(a + shift) % 3] = is_mirrored ? 6 - c[a] : c[a];
    return to;
  };
  VoxelGrid world = VoxelGrid::create({7, 7, 7}, 0.030).value();
  for (Cell c; c.z < 7; ++c.z) {
    for (c.y = 0; c.y < 7; ++c.y) {
      for (c.x = 0; c.x < 7; ++c.x) world.set_occupied(turned(c), grid.is_occupied(c));
    }
  }
  Composed sut(world, kTick, delayed_by(0.08));
  (void)sut.rest({}, 0.4);
  ZoneHand hand(seed, {}, 0.4);
  UndelayedGhostPoint person(grid, {}, {3, 3, 3});
  std::mt19937_64 random(seed);
  Rows rows;
  const double sign = is_mirrored ? -1 : 1;
  for (int i = 0; i < 2000; ++i) {
    if (i % 100 == 99) {
      Cell cell;
      for (std::size_t a = 0; a < 3; ++a) cell[a] = static_cast<std::int32_t>(random() % 7);
      sut.cells.set_cell(turned(cell), random() % 2 == 0);
    }
    hand.move(person.ghost(), kTick);
    (void)person.tick(hand.at(), hand.velocity(), kTick);
    Position3 tip;
    Velocity3 velocity;
    for (std::size_t a = 0; a < 3; ++a) {
      tip[(a + shift) % 3] = sign * hand.at()[a];
      velocity[(a + shift) % 3] = sign * hand.velocity()[a];
    }
    const ArmOutput out = sut.loop.tick(tip, velocity);
    std::array<double, 6> row{};
    for (std::size_t a = 0; a < 3; ++a) {
      row[a] = sign * out.force[(a + shift) % 3];
      row[3 + a] = sign * out.offset[(a + shift) % 3];
    }
    rows.push_back(row);
  }
  return rows;
}

TEST(Composite, MirroredAndPermutedWorldsGiveMirroredAndPermutedForces) {
  std::mt19937_64 random(723);
  for (std::uint64_t run = 0; run < 12; ++run) {
    VoxelGrid grid = VoxelGrid::create({7, 7, 7}, 0.030).value();
    for (Cell c; c.z < 7; ++c.z) {
      for (c.y = 0; c.y < 7; ++c.y) {
        for (c.x = 0; c.x < 7; ++c.x) grid.set_occupied(c, random() % 6 == 0);
      }
    }
    grid.set_occupied({3, 3, 3}, false);
    const Rows reference = turned_trace(grid, 0, false, run);
    for (const std::size_t shift : {0U, 1U, 2U}) {
      const Rows mirrored = turned_trace(grid, shift, true, run);
      const Rows permuted = turned_trace(grid, shift, false, run);
      for (std::size_t i = 0; i < reference.size(); ++i) {
        for (std::size_t j = 0; j < 6; ++j) {
          ASSERT_NEAR(mirrored[i][j], reference[i][j], 1e-9) << run << " " << i;
          ASSERT_NEAR(permuted[i][j], reference[i][j], 1e-9) << run << " " << i;
        }
      }
    }
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
