#include "daemon/world/near_cells.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "daemon/world/ghost_slide.hpp"
#include "daemon/world/near_cell_finder.hpp"
#include "tests/unit/world/grids.hpp"

namespace thimble::world {
namespace {

constexpr double kEdge_m = 0.25;

// A free cell and a place in it; none in a world that is full.
std::optional<GhostPoint> any_ghost(std::mt19937& random, const VoxelGrid& grid) {
  std::vector<Cell> free;
  for_each_cell(grid, [&](Cell c) {
    if (!grid.is_occupied(c)) free.push_back(c);
  });
  if (free.empty()) return std::nullopt;
  const Cell cell = free[random() % free.size()];
  GhostPoint ghost{center_of(grid, cell), cell};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (random() % 3 == 0) ghost.position[axis] = grid.face_m(axis, cell[axis]);
  }
  return ghost;
}

// Whether closed cell and closed box between the two, widened, have a point in common.
bool touches(const VoxelGrid& grid, Cell cell, const NearQuery& query) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double low = std::min(query.ghost[axis], query.hand[axis]) - query.reach_m;
    const double high = std::max(query.ghost[axis], query.hand[axis]) + query.reach_m;
    if (grid.face_m(axis, cell[axis] + 1) < low || grid.face_m(axis, cell[axis]) > high) {
      return false;
    }
  }
  return true;
}

// Nothing had to be left out.
bool is_whole(const VoxelGrid& grid, const NearCells& near, const NearQuery& query) {
  bool out = true;
  for_each_cell(grid, [&](Cell c) {
    out = out && (near.is_occupied(c) || !grid.is_occupied(c) || !touches(grid, c, query));
  });
  return out;
}

TEST(NearCells, NamesWhatIsOccupiedInReachAndNothingThatIsFree) {
  std::mt19937 random(601);
  NearCellFinder sut;
  int cut = 0;
  for (int run = 0; run < 3000; ++run) {
    const VoxelGrid grid = random_grid(random, uniform(random, 0, 0.6), kEdge_m);
    const auto ghost = any_ghost(random, grid);
    if (!ghost) continue;
    const NearQuery query{.middle = ghost->cell,
                          .ghost = ghost->position,
                          .hand = grid.clamp_near(random_point(random, grid)),
                          .reach_m = uniform(random, 0, 2) * kEdge_m};
    const NearCells near = sut.find(grid, query);
    ASSERT_TRUE(is_sound(near, ghost->position));
    for_each_cell(grid, [&](Cell c) {
      ASSERT_FALSE(near.is_occupied(c) && !grid.is_occupied(c)) << run;
      const Cell at{c.x - ghost->cell.x, c.y - ghost->cell.y, c.z - ghost->cell.z};
      if (query.reach_m >= kEdge_m && std::abs(at.x) <= 1 && std::abs(at.y) <= 1 &&
          std::abs(at.z) <= 1) {
        ASSERT_EQ(near.is_occupied(c), grid.is_occupied(c)) << run;
      }
    });
    if (!is_whole(grid, near, query)) ++cut;
    if (is_whole(grid, near, query)) {
      for_each_cell(
          grid, [&](Cell c) { ASSERT_TRUE(near.is_known(c) || !touches(grid, c, query)) << run; });
    }
    EXPECT_TRUE(near.is_occupied({-1, 0, 0})) << "the world has walls";
  }
  EXPECT_GT(cut, 30) << "some did not fit";
  EXPECT_LT(cut, 1500) << "most did";
}

TEST(NearCells, AGhostMovesThroughThemAsThroughTheGridAsFarAsTheyReach) {
  std::mt19937 random(602);
  NearCellFinder sut;
  int held = 0;
  for (int run = 0; run < 2000; ++run) {
    const VoxelGrid grid = random_grid(random, uniform(random, 0, 0.3), kEdge_m);
    const auto start = any_ghost(random, grid);
    if (!start) continue;
    GhostPoint ghost = *start;
    const Position3 first = grid.clamp_near(random_point(random, grid));
    const double reach_m = uniform(random, 0.1, 1) * kEdge_m;
    const NearQuery query{
        .middle = ghost.cell, .ghost = ghost.position, .hand = first, .reach_m = reach_m};
    const NearCells near = sut.find(grid, query);
    if (!is_whole(grid, near, query)) continue;
    GhostPoint known = ghost;
    for (int i = 0; i < 10; ++i) {
      Position3 hand = first;
      for (std::size_t axis = 0; axis < 3; ++axis) hand[axis] += uniform(random, -1, 1) * reach_m;
      const Slide expected = slide_ghost(grid, ghost, hand);
      const Slide found = slide_ghost(near, known, hand);
      ASSERT_EQ(found.ghost, expected.ghost) << run;
      ASSERT_EQ(found.held, expected.held) << run;
      ghost = expected.ghost;
      known = found.ghost;
      if (found.held != std::array<std::int8_t, 3>{}) ++held;
    }
  }
  EXPECT_GT(held, 2000);
}

TEST(NearCells, ReachNoFurtherThanARowOfTheirsInAWorldOfAnySize) {
  VoxelGrid grid = empty_grid({1024, 3, 3}, 1e-3);
  const Cell middle{500, 1, 1};
  grid.set_occupied({500 + kNearReach_cells, 1, 1}, true);
  grid.set_occupied({500 + kNearReach_cells + 1, 1, 1}, true);
  NearCellFinder sut;
  const NearCells near = sut.find(grid, {.middle = middle,
                                         .ghost = center_of(grid, middle),
                                         .hand = {1e300, -1e300, 0},
                                         .reach_m = 1e300});
  EXPECT_TRUE(near.is_occupied({500 + kNearReach_cells, 1, 1}));
  EXPECT_FALSE(near.is_occupied({500 + kNearReach_cells + 1, 1, 1}));
}

TEST(NearCells, AWallIsOneBoxWhicheverWayItFaces) {
  NearCellFinder sut;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    VoxelGrid grid = empty_grid({40, 40, 40}, 1e-3);
    for_each_cell(grid, [&](Cell c) { grid.set_occupied(c, c[axis] >= 25 && c[axis] < 28); });
    const Cell middle{20, 20, 20};
    const NearCells near = sut.find(grid, {.middle = middle,
                                           .ghost = center_of(grid, middle),
                                           .hand = center_of(grid, middle),
                                           .reach_m = 0.015});
    EXPECT_EQ(near.boxes.size(), 1U) << axis;
  }
}

TEST(NearCells, AreNotSoundWhenTheyCannotBe) {
  const VoxelGrid grid = empty_grid({4, 4, 4});
  const NearCells good =
      NearCellFinder::nothing(grid, {.middle = {1, 1, 1}, .ghost = center_of(grid, {1, 1, 1})});
  const Position3 ghost = center_of(grid, {1, 1, 1});
  ASSERT_TRUE(is_sound(good, ghost));
  const auto spoiled = [&](auto spoil) {
    NearCells bad = good;
    spoil(bad);
    return bad;
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(is_sound(spoiled([](NearCells& n) { n.lattice.cells[1] = 0; }), ghost));
  EXPECT_FALSE(is_sound(spoiled([](NearCells& n) { n.lattice.cells[1] = 1U << 31; }), ghost));
  EXPECT_FALSE(is_sound(spoiled([](NearCells& n) { n.lattice.half_cell_m = kNan; }), ghost));
  EXPECT_FALSE(is_sound(spoiled([](NearCells& n) { n.lattice.half_cell_m = -1; }), ghost));
  EXPECT_FALSE(is_sound(spoiled([](NearCells& n) { n.middle.x = -1; }), ghost));
  EXPECT_FALSE(is_sound(spoiled([](NearCells& n) { n.middle.z = 4; }), ghost));
  EXPECT_FALSE(is_sound(spoiled([](NearCells& n) { n.middle.x = 2; }), ghost)) << "is elsewhere";
  EXPECT_FALSE(is_sound(spoiled([](NearCells& n) { n.is_plane = true; }), ghost));
  EXPECT_FALSE(is_sound(good, {ghost.x, kNan, ghost.z}));
  NearCells plane = good;
  plane.lattice.cells[2] = 1;
  plane.middle.z = 0;
  plane.is_plane = true;
  EXPECT_TRUE(is_sound(plane, {ghost.x, ghost.y, 7}));
  EXPECT_FALSE(is_sound(plane, {ghost.x, ghost.y, kNan}));
}

TEST(NearCells, AZoneOfCellsHoldsEveryReachOfAnyPlaceInThem) {
  EXPECT_EQ(zone_cells(0.030, 0.030), 2)
      << "a ghost on a face, and the face of the cell after next";
  EXPECT_EQ(zone_cells(0.029, 0.030), 1);
  EXPECT_EQ(zone_cells(0, 0.030), 1);
  EXPECT_EQ(zone_cells(1, 0.001), kNearReach_cells);
  EXPECT_EQ(zone_cells(1e300, 1e-9), kNearReach_cells);
}

TEST(VoxelGrid, BitsOfARowAreItsCellsWhereverItBegins) {
  std::mt19937 random(603);
  VoxelGrid grid = empty_grid({100, 3, 2});
  for_each_cell(grid, [&](Cell c) { grid.set_occupied(c, random() % 2 == 0); });
  for (int run = 0; run < 2000; ++run) {
    const Cell from{index_below(random, 100), index_below(random, 3), index_below(random, 2)};
    const auto left = static_cast<std::size_t>(100 - from.x);
    const std::size_t count = 1 + random() % std::min<std::size_t>(64, left);
    const std::uint64_t bits = grid.bits_in_row(from, count);
    for (std::size_t i = 0; i < 64; ++i) {
      const Cell cell{from.x + static_cast<std::int32_t>(i), from.y, from.z};
      ASSERT_EQ((bits >> i & 1) != 0, i < count && grid.is_occupied(cell)) << run;
    }
  }
}

}  // namespace
}  // namespace thimble::world
