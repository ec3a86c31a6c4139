#include <gtest/gtest.h>

#include <random>

#include "daemon/world/ghost_motion.hpp"
#include "tests/unit/world/grids.hpp"
#include "tests/unit/world/symmetry.hpp"

namespace thimble::world {
namespace {

constexpr Duration kTick = std::chrono::milliseconds(1);

void expect_same_planes(const Symmetry& s, const ProbeMotion& original, const ProbeMotion& other) {
  ASSERT_EQ(original.planes.size(), other.planes.size());
  for (const ContactPlane& plane : original.planes) {
    ContactPlane expected = plane;
    expected.normal = image(s, plane.normal);
    bool is_there = false;
    for (const ContactPlane& candidate : other.planes) is_there |= candidate == expected;
    ASSERT_TRUE(is_there);
  }
}

// Runs one random program in a random world and in its image; everything must agree to the bit.
void run_pair(const Symmetry& s, unsigned seed, double flips_per_step) {
  std::mt19937 random(seed);
  const double cell_m = seed % 2 == 0 ? 0.25 : 0.09 / 7;  // exact on the lattice, and rounded
  VoxelGrid grid = random_grid(random, uniform(random, 0.1, 0.7), cell_m);
  GhostState ghost = ghost_in(grid, {1, 0, 1});
  grid.set_occupied(ghost.point.cell, false);
  VoxelGrid other_grid = image(s, grid);
  GhostState other = ghost;
  other.point = {image(s, ghost.point.position), image(s, grid, ghost.point.cell)};

  for (int step = 0; step < 60; ++step) {
    for (double flips = flips_per_step; uniform(random, 0, 1) < flips; flips -= 1) {
      const bool is_at_ghost = random() % 2 == 0;
      Cell c = ghost.point.cell;
      if (!is_at_ghost) {
        for (std::size_t a = 0; a < 3; ++a) c[a] = index_below(random, grid.cells()[a]);
      }
      const bool is_occupied = random() % 3 != 0;
      grid.set_occupied(c, is_occupied);
      other_grid.set_occupied(image(s, grid, c), is_occupied);
    }
    const Position3 hand = random_point(random, grid);
    const Duration dt = kTick * (1 + static_cast<int>(random() % 200));
    const ProbeMotion motion = move_ghost(grid, ghost, hand, dt);
    const ProbeMotion other_motion = move_ghost(other_grid, other, image(s, hand), dt);
    ASSERT_EQ(image(s, motion.ghost), other_motion.ghost) << "step " << step;
    ASSERT_EQ(image(s, grid, ghost.point.cell), other.point.cell) << "step " << step;
    ASSERT_EQ(ghost.phase, other.phase) << "step " << step;
    ASSERT_EQ(motion.is_embedded, other_motion.is_embedded);
    expect_same_planes(s, motion, other_motion);
  }
}

TEST(GhostSymmetry, ExchangedAndMirroredAxesGiveTheSameMotionToTheBit) {
  for (const Symmetry& s : all_symmetries()) {
    for (unsigned seed = 0; seed < 40; ++seed) {
      SCOPED_TRACE(seed);
      ASSERT_NO_FATAL_FAILURE(run_pair(s, seed, 0));
    }
  }
}

TEST(GhostSymmetry, HoldsWhileCellsFillAndEmpty) {
  for (const Symmetry& s : all_symmetries()) {
    for (unsigned seed = 1000; seed < 1040; ++seed) {
      SCOPED_TRACE(seed);
      ASSERT_NO_FATAL_FAILURE(run_pair(s, seed, 2.5));
    }
  }
}

}  // namespace
}  // namespace thimble::world
