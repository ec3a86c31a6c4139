#include "daemon/world/free_rows.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "daemon/world/voxel_world.hpp"
#include "tests/unit/world/grids.hpp"

namespace thimble::world {
namespace {

double distance2_m2(const VoxelGrid& grid, Cell cell, Position3 p) {
  double d[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    d[axis] = std::max({0.0, grid.face_m(axis, cell[axis]) - p[axis],
                        p[axis] - grid.face_m(axis, cell[axis] + 1)});
  }
  return (d[1] * d[1] + d[2] * d[2]) + d[0] * d[0];
}

// All cells, in the order that decides between equals.
std::optional<Cell> nearest_of_all(const VoxelGrid& grid, Position3 p) {
  double best = std::numeric_limits<double>::infinity();
  std::optional<Cell> out;
  for_each_cell(grid, [&](Cell cell) {
    if (grid.is_occupied(cell) || !(distance2_m2(grid, cell, p) < best)) return;
    best = distance2_m2(grid, cell, p);
    out = cell;
  });
  return out;
}

Cell random_cell(const VoxelGrid& grid, std::mt19937& random) {
  Cell cell;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    cell[axis] = static_cast<std::int32_t>(random() % grid.cells()[axis]);
  }
  return cell;
}

TEST(FreeRows, FindsWhatAWalkOverAllCellsFinds) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937 random(seed);
    const auto side = [&] { return static_cast<std::uint32_t>(1 + random() % 9); };
    // Some with more rows than a word has bits.
    VoxelGrid grid = empty_grid({side(), seed % 10 == 0 ? 60 + side() * 10 : side(), side()});
    grid.fill();
    FreeRows sut(grid);
    for (int step = 0; step < 40; ++step) {
      const Cell cell = random_cell(grid, random);
      const bool is_filled = random() % 3 == 0;
      grid.set_occupied(cell, is_filled);
      sut.note_changed(grid, cell);
      // Half of them on faces and corners, where many are equally near; some outside.
      Position3 p;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        p[axis] = static_cast<double>(static_cast<int>(random() % 41) - 20) * 0.0625 +
                  (step % 2 == 0 ? 0 : uniform(random, -0.1, 0.1));
      }
      EXPECT_EQ(sut.nearest(grid, grid.clamp_near(p)), nearest_of_all(grid, grid.clamp_near(p)))
          << "seed " << seed << " step " << step;
    }
  }
}

constexpr std::int32_t kSide = 128;
constexpr std::uint64_t kFew = 8 * kSide;  // layers, rows and cells; the world has 2 million

VoxelGrid with_one_free_cell(Cell cell) {
  VoxelGrid grid = empty_grid({kSide, kSide, kSide}, 0.001);
  grid.fill();
  grid.set_occupied(cell, false);
  return grid;
}

TEST(FreeRows, OneFreeCellOfALargeWorldIsFoundWithoutWalkingIt) {
  std::mt19937 random(1);
  for (int i = 0; i < 20; ++i) {
    const Cell only = random_cell(with_one_free_cell({}), random);
    VoxelWorld sut(with_one_free_cell(only), "test");
    for (int session = 0; session < 50; ++session) {
      const std::uint64_t before = sut.looked_at();
      const Position3 hand{uniform(random, -0.1, 0.1), uniform(random, -0.1, 0.1),
                           uniform(random, -0.1, 0.1)};
      const auto probe = sut.add_probe(hand);
      ASSERT_TRUE(probe);
      EXPECT_LE(sut.looked_at() - before, kFew);
      sut.remove_probe(*probe);
    }
  }
}

TEST(FreeRows, NoSearchHasToFindOutWhatWasFilled) {
  VoxelWorld sut(empty_grid({kSide, kSide, kSide}, 0.001), "test");
  for (Cell row; row.z < kSide; ++row.z) {
    for (row.y = 0; row.y < kSide; ++row.y) sut.set_row(row, kSide, 1);
  }
  sut.set_cell({kSide - 1, kSide - 1, kSide - 1}, false);
  const Position3 far_corner{-0.1, -0.1, -0.1};
  ASSERT_TRUE(sut.add_probe(far_corner));
  EXPECT_LE(sut.looked_at(), kFew) << "not even the first one";
}

// However cells come and go, by the cell or by the row.
TEST(FreeRows, NoFullRowIsEverLookedInto) {
  constexpr std::int32_t kEnd = 16;
  std::mt19937 random(3);
  VoxelWorld sut(empty_grid({kEnd, kEnd, kEnd}, 0.001), "test");
  for (int step = 0; step < 3000; ++step) {
    Cell cell;
    for (std::size_t axis = 0; axis < 3; ++axis)
      cell[axis] = static_cast<std::int32_t>(random() % kEnd);
    if (random() % 4 == 0) {
      sut.set_cell(cell, random() % 2 == 0);
    } else {
      sut.set_row({0, cell.y, cell.z}, kEnd, random() % 20 == 0 ? 0 : 1);
    }
    std::uint64_t free_rows = 0;
    for (Cell row; row.z < kEnd; ++row.z) {
      for (row.y = 0; row.y < kEnd; ++row.y) {
        free_rows += sut.grid()->next_free_in_row(row) < kEnd ? 1U : 0U;
      }
    }
    const std::uint64_t before = sut.looked_at();
    const auto probe = sut.add_probe({uniform(random, -0.01, 0.01), 0, 0});
    ASSERT_EQ(probe.has_value(), free_rows > 0);
    EXPECT_LE(sut.looked_at() - before, kEnd + free_rows * kEnd);
    if (probe) sut.remove_probe(*probe);
  }
}

TEST(FreeRows, AnEditThatFreesIsFoundFromThenOn) {
  VoxelWorld sut(with_one_free_cell({0, 0, 0}), "test");
  ASSERT_TRUE(sut.add_probe({0.064, 0.064, 0.064}));
  sut.set_row({kSide - 3, kSide - 1, kSide - 1}, kSide - 2, 0);
  const ProbeId probe = sut.add_probe({0.1, 0.1, 0.1}).value();
  const ProbeMotion motion = sut.move_probe(probe, {0.1, 0.1, 0.1}, std::chrono::milliseconds(1));
  EXPECT_NEAR(motion.ghost.x, 0.062, 1e-9);
}

}  // namespace
}  // namespace thimble::world
