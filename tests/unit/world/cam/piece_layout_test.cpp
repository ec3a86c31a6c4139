#include "daemon/world/cam/piece_layout.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace thimble::world::cam {
namespace {

constexpr CamGeometry kPlane{{6, 6, 0}, CamDivision::Mesh};

// In a row of cells along an axis, no piece is thinner than it must be.
void expect_thick(const PieceLayout& layout, const CamGeometry& space, std::size_t axis) {
  const CamAxes cells = cells_along(space);
  CamAxes at{};
  for (std::size_t i = 0; i < layout.size(); ++i) {
    at = {static_cast<int>(i) % cells[0], static_cast<int>(i) / cells[0] % cells[1],
          static_cast<int>(i) / cells[0] / cells[1]};
    if (at[axis] != 0) continue;
    int run = 0;
    for (; at[axis] <= cells[axis]; ++at[axis]) {
      const bool is_end = at[axis] == cells[axis] || layout[index_of(space, at)] == 0;
      if (!is_end) {
        ++run;
        continue;
      }
      EXPECT_TRUE(run == 0 || run >= kLeastThickness_cells) << run;
      run = 0;
    }
  }
}

TEST(RandomLayout, HasAllPiecesApartThickAndClearOfTheMiddle) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto layout = random_layout(kPlane, 12, seed);
    ASSERT_TRUE(layout) << layout.error().message;
    ASSERT_EQ(layout->size(), kPlane.cells());
    const PieceSizes sizes = sizes_of(*layout);
    for (std::size_t part = 1; part <= 12; ++part) EXPECT_GE(sizes[part], 16U);
    for (std::size_t part = 13; part < sizes.size(); ++part) EXPECT_EQ(sizes[part], 0U);
    EXPECT_EQ((*layout)[index_of(kPlane, {32, 32, 0})], 0);
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x + 1 < 64; ++x) {
        const int here = (*layout)[index_of(kPlane, {x, y, 0})];
        const int next = (*layout)[index_of(kPlane, {x + 1, y, 0})];
        const int down = y == 63 ? 0 : (*layout)[index_of(kPlane, {x, y + 1, 0})];
        EXPECT_TRUE(here == 0 || next == 0 || here == next);
        EXPECT_TRUE(here == 0 || down == 0 || here == down);
      }
    }
    expect_thick(*layout, kPlane, 0);
    expect_thick(*layout, kPlane, 1);
  }
}

bool is_in(const CamBox& box, const CamGeometry& space, const CamAxes& cell) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int behind = (cell[axis] - box.first[axis]) & ((1 << space.log2_cells[axis]) - 1);
    if (behind >= box.cells[axis]) return false;
  }
  return true;
}

// Pieces that lie over the edges, in one part or several.
TEST(PieceBoxes, AreTheLeastAroundAllOfAPiece) {
  constexpr CamGeometry kSpace{{4, 3, 2}, CamDivision::Mesh};
  std::mt19937 random(6);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  for (int i = 0; i < 300; ++i) {
    std::vector<CamAxes> cells;
    const CamAxes corner{below(16), below(8), below(4)};
    for (int n = 1 + below(6); n > 0; --n) {
      cells.push_back(
          {(corner[0] + below(5)) & 15, (corner[1] + below(4)) & 7, (corner[2] + below(2)) & 3});
    }
    PieceLayout layout(kSpace.cells());
    for (const CamAxes& cell : cells) layout[index_of(kSpace, cell)] = 9;
    const CamBox box = boxes_of(kSpace, layout)[9];
    for (const CamAxes& cell : cells) ASSERT_TRUE(is_in(box, kSpace, cell));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      // Nothing shorter has all of them, wherever it begins.
      for (int first = 0; first < 1 << kSpace.log2_cells[axis]; ++first) {
        CamBox shorter = box;
        shorter.first[axis] = first;
        --shorter.cells[axis];
        EXPECT_FALSE(std::all_of(cells.begin(), cells.end(), [&](const CamAxes& cell) {
          return is_in(shorter, kSpace, cell);
        }));
      }
    }
  }
}

TEST(PieceBoxes, SweepOverAllThatLiesBetween) {
  constexpr CamGeometry kSpace{{5, 4, 0}, CamDivision::Mesh};
  const CamBox box{{30, 3, 0}, {4, 2, 1}};
  EXPECT_EQ(moved_by(kSpace, box, {5, -4, 0}), (CamBox{{3, 15, 0}, {4, 2, 1}}));
  EXPECT_EQ(swept_by(kSpace, box, {5, -4, 0}), (CamBox{{30, 15, 0}, {9, 6, 1}}));
  EXPECT_EQ(swept_by(kSpace, box, {-40, 100, 3}).cells, (CamAxes{32, 16, 1}));
  EXPECT_EQ(swept_by(kSpace, box, {}), box);
}

TEST(RandomLayout, IsTheSameForTheSameSeedOnly) {
  EXPECT_EQ(random_layout(kPlane, 9, 5), random_layout(kPlane, 9, 5));
  EXPECT_NE(random_layout(kPlane, 9, 5), random_layout(kPlane, 9, 6));
}

TEST(RandomLayout, TheThesissSpaceHasRoomForAllSixtyThree) {
  const CamGeometry thesis{{9, 9, 0}, CamDivision::StripY};
  EXPECT_TRUE(random_layout(thesis, kMostPieces, 1));
  const CamGeometry cube{{6, 6, 6}, CamDivision::StripY};
  EXPECT_TRUE(random_layout(cube, 20, 1));
}

TEST(RandomLayout, TooManyAreRefused) {
  EXPECT_EQ(random_layout(kPlane, 64, 1).error().code, Errc::InvalidArgument);
  EXPECT_EQ(random_layout(kPlane, -1, 1).error().code, Errc::InvalidArgument);
  EXPECT_EQ(random_layout({{4, 4, 0}, CamDivision::Mesh}, 30, 1).error().code,
            Errc::InvalidArgument);
}

}  // namespace
}  // namespace thimble::world::cam
