#include "daemon/world/ghost_slide.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/unit/world/grids.hpp"

namespace thimble::world {
namespace {

GhostPoint in_cell(const VoxelGrid& grid, Cell cell) { return {center_of(grid, cell), cell}; }

bool is_in_closed_box(const VoxelGrid& grid, const GhostPoint& ghost) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double p = ghost.position[axis];
    if (!(p >= grid.face_m(axis, ghost.cell[axis]))) return false;
    if (!(p <= grid.face_m(axis, ghost.cell[axis] + 1))) return false;
  }
  return true;
}

// Whether free cells joined by faces lead from `at` to `end`, every step towards `end`.
bool is_reachable(const VoxelGrid& grid, Cell at, Cell end) {
  if (at == end) return true;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (at[axis] == end[axis]) continue;
    Cell next = at;
    next[axis] += end[axis] > at[axis] ? 1 : -1;
    if (!grid.is_occupied(next) && is_reachable(grid, next, end)) return true;
  }
  return false;
}

// The thesis's rule by brute force: very small steps straight at the target, each axis by itself,
// undone when it would enter an occupied cell.
Position3 creep(const VoxelGrid& grid, GhostPoint ghost, Position3 target) {
  constexpr double kStep_m = 1e-3;  // in cells of 0.25 m
  std::array<bool, 3> is_stopped{};
  for (int step = 0; step < 10000; ++step) {
    Displacement3 rest = target - ghost.position;
    const Displacement3 whole = rest;
    for (std::size_t axis = 0; axis < 3; ++axis) rest[axis] = is_stopped[axis] ? 0 : rest[axis];
    const double distance_m = norm(rest);
    if (distance_m == 0) break;
    const double share = std::min(1.0, kStep_m / distance_m);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double to = share == 1 ? target[axis] : ghost.position[axis] + share * whole[axis];
      Cell cell = ghost.cell;
      if (to > grid.face_m(axis, cell[axis] + 1)) ++cell[axis];
      if (to < grid.face_m(axis, cell[axis])) --cell[axis];
      is_stopped[axis] = cell != ghost.cell && grid.is_occupied(cell);
      if (is_stopped[axis]) {
        const bool is_up = cell[axis] > ghost.cell[axis];
        ghost.position[axis] = grid.face_m(axis, ghost.cell[axis] + (is_up ? 1 : 0));
        continue;
      }
      ghost.cell = cell;
      ghost.position[axis] = to;
    }
  }
  return ghost.position;
}

TEST(GhostSlide, ReachesTheTargetThroughFreeSpace) {
  std::mt19937 random(10);
  const VoxelGrid grid = empty_grid({9, 9, 9});
  GhostPoint ghost = in_cell(grid, {4, 4, 4});
  for (int step = 0; step < 2000; ++step) {
    Position3 target;
    for (std::size_t axis = 0; axis < 3; ++axis) target[axis] = uniform(random, -1.1, 1.1);
    const Slide sut = slide_ghost(grid, ghost, target);
    ASSERT_EQ(sut.ghost.position, target);
    ASSERT_EQ(sut.held, (std::array<std::int8_t, 3>{}));
    ASSERT_TRUE(is_in_closed_box(grid, sut.ghost));
    ghost = sut.ghost;
  }
}

TEST(GhostSlide, KeepsItsInvariantsInRandomWorlds) {
  std::mt19937 random(11);
  for (int world = 0; world < 300; ++world) {
    VoxelGrid grid = random_grid(random, uniform(random, 0.05, 0.6), 0.25);
    GhostPoint ghost = in_cell(grid, {0, 0, 0});
    grid.set_occupied(ghost.cell, false);
    for (int step = 0; step < 60; ++step) {
      const Position3 target = random_point(random, grid);
      const Slide sut = slide_ghost(grid, ghost, target);
      ASSERT_TRUE(is_in_closed_box(grid, sut.ghost));
      ASSERT_FALSE(grid.is_occupied(sut.ghost.cell));
      ASSERT_TRUE(is_reachable(grid, ghost.cell, sut.ghost.cell));
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double rest = target[axis] - sut.ghost.position[axis];
        const int held = sut.held[axis];
        ASSERT_TRUE(held == 0 ? rest == 0 : rest * held >= 0);
        if (held == 0) continue;
        const std::int32_t face = sut.ghost.cell[axis] + (held > 0 ? 1 : 0);
        ASSERT_EQ(sut.ghost.position[axis], grid.face_m(axis, face));
      }
      ghost = sut.ghost;
    }
  }
}

TEST(GhostSlide, AgreesWithCreepingInRandomWorlds) {
  std::mt19937 random(12);
  int compared = 0;
  int different = 0;
  for (int world = 0; world < 60; ++world) {
    VoxelGrid grid = random_grid(random, 0.3, 0.25);
    GhostPoint ghost = in_cell(grid, {0, 0, 0});
    grid.set_occupied(ghost.cell, false);
    for (int step = 0; step < 20; ++step) {
      Position3 target = random_point(random, grid);
      for (std::size_t axis = 0; axis < 3; ++axis) target[axis] += uniform(random, -0.1, 0.1);
      const Slide sut = slide_ghost(grid, ghost, target);
      ++compared;
      if (norm(sut.ghost.position - creep(grid, ghost, target)) > 5e-3) ++different;
      ghost = sut.ghost;
    }
  }
  // Creeping itself misses an edge by up to a step, after which the two ways part.
  EXPECT_LE(different, compared / 50) << compared;
}

TEST(GhostSlide, GoesOnWithAStoppedAxisPastTheEdge) {
  VoxelGrid grid = empty_grid({4, 4, 1}, 1.0);
  grid.set_occupied({1, 1, 0}, true);
  // From below, half left of the obstacle's right edge; pressed up while moving right.
  const GhostPoint from{{-0.5, -1.5, 0}, {1, 0, 0}};
  const Slide under = slide_ghost(grid, from, {-0.1, 1.5, 0});
  EXPECT_EQ(under.ghost.position, (Position3{-0.1, -1, 0}));
  EXPECT_EQ(under.held[1], 1);
  const Slide past = slide_ghost(grid, under.ghost, {0.1, 1.5, 0});
  EXPECT_EQ(past.ghost.position, (Position3{0.1, 1.5, 0}));
  EXPECT_EQ(past.held[1], 0);
}

TEST(GhostSlide, StopsExactlyOnTheFaceOnBothSides) {
  const VoxelGrid grid = make_box(3).value();
  const GhostPoint from = in_cell(grid, {1, 1, 1});
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const int way : {-1, 1}) {
      Position3 target{0.001, 0.002, 0.003};
      target[axis] = 0.02 * way;
      const Slide sut = slide_ghost(grid, from, target);
      Position3 expected = target;
      expected[axis] = grid.face_m(axis, way > 0 ? 2 : 1);
      EXPECT_EQ(sut.ghost.position, expected);
      EXPECT_EQ(sut.held[axis], way);
    }
  }
}

TEST(GhostSlide, RestsOnTheEdgeOfACornerMetDeadOn) {
  VoxelGrid grid = empty_grid({4, 4, 1}, 1.0);
  grid.set_occupied({2, 2, 0}, true);
  const GhostPoint from{{-0.5, -0.5, 0}, {1, 1, 0}};
  const Slide dead_on = slide_ghost(grid, from, {0.5, 0.5, 0});
  EXPECT_EQ(dead_on.ghost, (GhostPoint{{0, 0, 0}, {1, 1, 0}}));
  EXPECT_EQ(dead_on.held, (std::array<std::int8_t, 3>{1, 1, 0}));
  // The smallest preference for one side takes it round that side.
  const double more = std::nextafter(0.5, 1);
  EXPECT_EQ(slide_ghost(grid, dead_on.ghost, {more, 0.5, 0}).ghost.position,
            (Position3{more, 0, 0}));
  EXPECT_EQ(slide_ghost(grid, dead_on.ghost, {0.5, more, 0}).ghost.position,
            (Position3{0, more, 0}));
}

TEST(GhostSlide, CrossesTheFacesOfATieInWhateverOrderIsFree) {
  VoxelGrid grid = empty_grid({2, 2, 2}, 1.0);
  const GhostPoint from = in_cell(grid, {0, 0, 0});
  // Only the way x, then y, then z is free.
  for_each_cell(grid, [&](Cell c) { grid.set_occupied(c, true); });
  for (const Cell c : {Cell{0, 0, 0}, Cell{1, 0, 0}, Cell{1, 1, 0}, Cell{1, 1, 1}}) {
    grid.set_occupied(c, false);
  }
  EXPECT_EQ(slide_ghost(grid, from, {0.5, 0.5, 0.5}).ghost.cell, (Cell{1, 1, 1}));
  grid.set_occupied({1, 1, 0}, true);
  const Slide stopped = slide_ghost(grid, from, {0.5, 0.5, 0.5});
  EXPECT_EQ(stopped.ghost.cell, (Cell{1, 0, 0}));
  EXPECT_EQ(stopped.held, (std::array<std::int8_t, 3>{0, 1, 1}));
}

TEST(GhostSlide, TakesWhatTwoEqualWaysHaveInCommon) {
  // From (0,0,0) both {x,z} and {y,z} can be crossed, nothing more: only z is sure.
  VoxelGrid grid = empty_grid({2, 2, 2}, 1.0);
  grid.set_occupied({1, 1, 0}, true);
  grid.set_occupied({1, 1, 1}, true);
  const Slide sut = slide_ghost(grid, in_cell(grid, {0, 0, 0}), {0.5, 0.5, 0.5});
  EXPECT_EQ(sut.ghost, (GhostPoint{{0, 0, 0.5}, {0, 0, 1}}));
  EXPECT_EQ(sut.held, (std::array<std::int8_t, 3>{1, 1, 0}));
}

TEST(GhostSlide, ALegOfZeroLengthChangesNothing) {
  std::mt19937 random(13);
  VoxelGrid grid = random_grid(random, 0.4, 0.25);
  GhostPoint ghost = in_cell(grid, {1, 1, 1});
  grid.set_occupied(ghost.cell, false);
  for (int step = 0; step < 500; ++step) {
    const Slide moved = slide_ghost(grid, ghost, random_point(random, grid));
    const Slide again = slide_ghost(grid, moved.ghost, moved.ghost.position);
    ASSERT_EQ(again.ghost, moved.ghost);
    ghost = moved.ghost;
  }
}

TEST(GhostSlide, IsDefinedForTheSmallestAndTheLargestNumbers) {
  const VoxelGrid grid = empty_grid({4, 4, 4}, 1.0);
  const double tiny = std::numeric_limits<double>::denorm_min();
  const double huge = std::numeric_limits<double>::max();
  // From the middle face, where the shortest legs cross.
  const GhostPoint from{{0, 0, 0}, {1, 1, 1}};
  for (const double x : {tiny, -tiny, 1e300, -1e300, huge, -huge, 2.0, -2.0}) {
    for (const double y : {0.0, tiny, -tiny, huge, -1e-300}) {
      const Slide sut = slide_ghost(grid, from, {x, y, -x});
      ASSERT_TRUE(is_finite(sut.ghost.position));
      ASSERT_TRUE(is_in_closed_box(grid, sut.ghost));
      ASSERT_EQ(sut.ghost.position, (Position3{std::clamp(x, -2.0, 2.0), std::clamp(y, -2.0, 2.0),
                                               std::clamp(-x, -2.0, 2.0)}));
    }
  }
}

TEST(GhostSlide, ReportsAFaceThatIsOnlyTouchedOnBothSides) {
  const VoxelGrid grid = make_box(3).value();
  const GhostPoint from = in_cell(grid, {1, 1, 1});
  for (const int way : {-1, 1}) {
    const double face = grid.face_m(0, way > 0 ? 2 : 1);
    EXPECT_EQ(slide_ghost(grid, from, {face, 0, 0}).held[0], way);
    EXPECT_EQ(slide_ghost(grid, from, {std::nextafter(face, 0), 0, 0}).held[0], 0);
  }
}

}  // namespace
}  // namespace thimble::world
