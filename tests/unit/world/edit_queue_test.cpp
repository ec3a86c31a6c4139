#include "daemon/world/edit_queue.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "tests/unit/world/grids.hpp"

namespace thimble::world {
namespace {

using Kind = CellEdit::Kind;

VoxelWorld two_materials(std::array<std::uint32_t, 3> cells) {
  return VoxelWorld(empty_grid(cells, 0.002), "w",
                    MaterialMap::create(cells, {{{100}}, {{200}}}).value());
}

// What an edit means, cell by cell.
bool is_meant(const VoxelGrid& grid, const CellEdit& edit, Cell cell) {
  if (edit.kind == Kind::Paint) {
    return norm(center_of(grid, cell) - edit.center) <= edit.radius_m;
  }
  bool is_outer = false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (cell[axis] < edit.first[axis] || cell[axis] > edit.last[axis]) return false;
    is_outer = is_outer || cell[axis] == edit.first[axis] || cell[axis] == edit.last[axis];
  }
  return edit.kind == Kind::Fill || is_outer;
}

CellEdit random_edit(std::mt19937& random, const VoxelGrid& grid) {
  CellEdit edit;
  edit.kind = static_cast<Kind>(random() % 3);
  edit.value = static_cast<std::uint8_t>(random() % 4);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    edit.first[axis] = index_below(random, grid.cells()[axis]);
    edit.last[axis] = index_below(random, grid.cells()[axis]);
    if (edit.first[axis] > edit.last[axis]) std::swap(edit.first[axis], edit.last[axis]);
  }
  edit.center = random_point(random, grid);
  edit.radius_m = uniform(random, 0.0001, 0.03);
  return edit;
}

Stiffness stiffness_of(VoxelWorld& world, Cell wall, Cell beside) {
  const VoxelGrid& grid = *world.grid();
  const ProbeId probe = world.add_probe(center_of(grid, beside)).value();
  const auto motion = world.move_probe(probe, center_of(grid, wall), std::chrono::milliseconds(1));
  world.remove_probe(probe);
  return motion.planes.empty() ? Stiffness{0} : motion.planes[0].stiffness;
}

void finish(EditQueue& queue) {
  for (int i = 0; i < 100000 && !queue.is_idle(); ++i) queue.step();
  ASSERT_TRUE(queue.is_idle());
}

TEST(EditQueue, RandomEditsDoWhatTheyMeanCellByCell) {
  std::mt19937 random(5);
  for (int round = 0; round < 30; ++round) {
    const auto some = [&](std::uint32_t most) {
      return static_cast<std::uint32_t>(random()) % most;
    };
    VoxelWorld world = two_materials({70 + some(9), 1 + some(12), 1 + some(12)});
    EditQueue sut(world);
    VoxelGrid expected = *world.grid();
    for (int i = 0; i < 20; ++i) {
      const CellEdit edit = random_edit(random, expected);
      std::uint64_t changed = 0;
      for_each_cell(expected, [&](Cell cell) {
        if (!is_meant(expected, edit, cell)) return;
        if (expected.is_occupied(cell) != (edit.value > 0)) ++changed;
        expected.set_occupied(cell, edit.value > 0);
      });
      const auto number = sut.submit({edit});
      ASSERT_TRUE(number) << number.error().message;
      finish(sut);
      const auto finished = sut.take_finished();
      ASSERT_EQ(finished.size(), 1U);
      EXPECT_EQ(finished[0].batch, *number);
      EXPECT_EQ(finished[0].changed_cells, changed);
      ASSERT_EQ(*world.grid(), expected);
      ASSERT_EQ(world.occupied_cells(), expected.count_occupied());
    }
    EXPECT_EQ(sut.applied(), 20U);
    EXPECT_EQ(sut.waiting(), 0U);
  }
}

TEST(EditQueue, ACellIsOfTheMaterialThatWasSaid) {
  VoxelWorld world = two_materials({5, 5, 5});
  EditQueue sut(world);
  for (const auto& [value, newton_per_m] :
       std::vector<std::pair<std::uint8_t, double>>{{2, 100}, {3, 200}, {1, -1}, {3, 200}}) {
    ASSERT_TRUE(sut.submit({{Kind::Fill, {2, 0, 0}, {3, 4, 4}, {}, 0, value}}));
    finish(sut);
    EXPECT_EQ(stiffness_of(world, {2, 2, 2}, {1, 2, 2}).newton_per_m, newton_per_m);
  }
}

TEST(EditQueue, OneSliceIsBoundedAndALargeFillTakesMany) {
  VoxelWorld world(empty_grid({128, 128, 128}, 0.001), "w");
  EditQueue sut(world);
  ASSERT_TRUE(sut.submit({{Kind::Fill, {}, {127, 127, 127}, {}, 0, 1}}));
  int slices = 0;
  std::size_t before = 0;
  for (; !sut.is_idle(); ++slices) {
    sut.step();
    ASSERT_LE(world.occupied_cells() - before, EditQueue::kSliceWords * 64);
    before = world.occupied_cells();
  }
  EXPECT_GE(slices, 4);
  EXPECT_EQ(world.occupied_cells(), 128U * 128 * 128);
}

TEST(EditQueue, KeepsTheOrderAcrossBatches) {
  VoxelWorld world(empty_grid({8, 8, 8}, 0.01), "w");
  EditQueue sut(world);
  const CellEdit fill{Kind::Fill, {}, {7, 7, 7}, {}, 0, 1};
  const CellEdit clear{Kind::Fill, {2, 2, 2}, {5, 5, 5}, {}, 0, 0};
  ASSERT_EQ(sut.submit({fill, clear}).value(), 1U);
  ASSERT_EQ(sut.submit({clear, fill}).value(), 2U);
  EXPECT_EQ(sut.waiting(), 4U);
  finish(sut);
  const auto finished = sut.take_finished();
  ASSERT_EQ(finished.size(), 2U);
  EXPECT_EQ(finished[0].changed_cells, 512U + 64);
  EXPECT_EQ(finished[1].changed_cells, 64U);
  EXPECT_EQ(world.occupied_cells(), 512U);
  EXPECT_TRUE(sut.take_finished().empty());
}

TEST(EditQueue, RefusesTheWholeBatchWithItsFirstMistake) {
  VoxelWorld world = two_materials({4, 5, 6});
  EditQueue sut(world);
  const CellEdit good{Kind::Fill, {}, {3, 4, 5}, {}, 0, 1};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const CellEdit& bad :
       {CellEdit{Kind::Fill, {-1, 0, 0}, {1, 1, 1}, {}, 0, 1},
        CellEdit{Kind::Box, {0, 0, 0}, {4, 1, 1}, {}, 0, 1},
        CellEdit{Kind::Fill, {0, 3, 0}, {1, 2, 1}, {}, 0, 1},
        CellEdit{Kind::Fill, {}, {}, {}, 0, 4}, CellEdit{Kind::Paint, {}, {}, {}, 0, 1},
        CellEdit{Kind::Paint, {}, {}, {nan, 0, 0}, 1, 1},
        CellEdit{Kind::Paint, {}, {}, {}, nan, 1}}) {
    const auto alone = sut.submit({bad});
    ASSERT_FALSE(alone);
    EXPECT_EQ(alone.error().code, Errc::InvalidArgument);
    EXPECT_EQ(alone.error().message.find("edit "), std::string::npos);
    const auto after_good = sut.submit({good, bad});
    ASSERT_FALSE(after_good);
    EXPECT_TRUE(after_good.error().message.starts_with("edit 1: ")) << after_good.error().message;
  }
  EXPECT_TRUE(sut.is_idle());
  EXPECT_EQ(world.occupied_cells(), 0U);
}

TEST(EditQueue, BoundsWhatMayWait) {
  VoxelWorld world(empty_grid({4, 4, 4}, 0.01), "w");
  EditQueue sut(world);
  for (std::size_t i = 0; i < EditQueue::kMaxBatches; ++i) ASSERT_TRUE(sut.submit({CellEdit{}}));
  const auto more = sut.submit({CellEdit{}});
  ASSERT_FALSE(more);
  EXPECT_EQ(more.error().code, Errc::Busy);
  sut.step();
  EXPECT_TRUE(sut.submit({CellEdit{}}));
}

// Whatever was taken, the slices to its end are no more than the bound says.
TEST(EditQueue, WhatWaitsEndsWithinABoundedNumberOfSlices) {
  constexpr std::size_t kSlices = EditQueue::kMaxWaitingWords / EditQueue::kSliceWords;
  std::mt19937 random(6);
  VoxelWorld world(empty_grid({1024, 1024, 64}, 0.001), "w");
  EditQueue sut(world);
  const CellEdit all{Kind::Fill, {}, {1023, 1023, 63}, {}, 0, 1};
  const auto too_large = sut.submit(std::vector<CellEdit>(64, all));
  ASSERT_FALSE(too_large);
  EXPECT_EQ(too_large.error().code, Errc::TooLarge);
  std::size_t taken = 0;
  for (Result<std::uint64_t> last = 0; last; ++taken) {
    CellEdit other = random_edit(random, *world.grid());
    other.value = 0;
    last = sut.submit({all, other});
    if (last) continue;
    EXPECT_EQ(last.error().code, Errc::Busy);
  }
  EXPECT_LT(taken, EditQueue::kMaxBatches);
  EXPECT_GT(taken, 16U);
  std::size_t slices = 0;
  for (; !sut.is_idle(); ++slices) sut.step();
  EXPECT_LE(slices, kSlices);
  EXPECT_GT(slices, kSlices / 2);
  ASSERT_TRUE(sut.submit({all})) << "room again";
}

TEST(EditQueue, ABatchIsWithdrawnAsAWholeOrNotAtAll) {
  VoxelWorld world(empty_grid({1024, 256, 16}, 0.001), "w");
  EditQueue sut(world);
  const CellEdit all{Kind::Fill, {}, {1023, 255, 15}, {}, 0, 1};
  const CellEdit one{};
  const auto begun = sut.submit({all, one}).value();
  const auto waits = sut.submit({all, one}).value();
  const auto last = sut.submit({CellEdit{Kind::Fill, {}, {}, {}, 0, 0}}).value();
  sut.step();
  for (const std::uint64_t batch : {begun, waits, waits, last + 1}) sut.withdraw(batch);
  EXPECT_EQ(sut.waiting(), 3U);
  finish(sut);
  sut.withdraw(begun);
  const auto finished = sut.take_finished();
  ASSERT_EQ(finished.size(), 2U);
  EXPECT_EQ(finished[0].batch, begun);
  EXPECT_EQ(finished[1].batch, last);
  EXPECT_EQ(world.occupied_cells(), 1024U * 256 * 16 - 1);
  EXPECT_EQ(sut.waiting(), 0U);
}

TEST(EditQueue, ABrushBesideTheWorldPaintsNothing) {
  VoxelWorld world(empty_grid({4, 4, 4}, 0.01), "w");
  EditQueue sut(world);
  for (const Position3 center : {Position3{9, 0, 0}, {0, -kMaxBrush_m, 0}, {0, 0, kMaxBrush_m}}) {
    ASSERT_TRUE(sut.submit({{Kind::Paint, {}, {}, center, 0.5, 1}}));
  }
  finish(sut);
  EXPECT_EQ(world.occupied_cells(), 0U);
  ASSERT_TRUE(sut.submit({{Kind::Paint, {}, {}, {}, kMaxBrush_m, 1}}));
  finish(sut);
  EXPECT_EQ(world.occupied_cells(), 64U);
}

// Huge less huge is no number, and no number is no cell.
TEST(EditQueue, ABrushIsHugeOnAnyAxesAndItsRadiusTooAndIsRefused) {
  VoxelWorld world(empty_grid({4, 5, 6}, 1e-9), "w");
  EditQueue sut(world);
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double huge : {1.001 * kMaxBrush_m, 1e154, 1e308, infinity}) {
    for (int axes = 0; axes < 27; ++axes) {
      const auto along = [&](int power) { return huge * (axes / power % 3 - 1); };
      const Position3 center{along(1), along(3), along(9)};
      for (const double radius_m : {0.001, kMaxBrush_m, huge}) {
        const bool is_good = axes == 13 && huge < infinity && radius_m <= kMaxBrush_m;
        if (is_good) continue;
        const auto refused = sut.submit({{Kind::Paint, {}, {}, center, radius_m, 1}});
        ASSERT_FALSE(refused) << axes << " " << huge << " " << radius_m;
        EXPECT_EQ(refused.error().code, Errc::InvalidArgument);
      }
    }
  }
  for (const double x : {-kMaxBrush_m, kMaxBrush_m}) {
    ASSERT_TRUE(sut.submit({{Kind::Paint, {}, {}, {x, -x, x}, kMaxBrush_m, 1}}));
  }
  sut.step();
  EXPECT_TRUE(sut.is_idle());
}

}  // namespace
}  // namespace thimble::world
