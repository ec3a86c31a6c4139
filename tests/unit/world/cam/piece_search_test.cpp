#include "daemon/world/cam/piece_search.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>
#include <random>
#include <set>

#include "tests/unit/world/cam/greedy_walk.hpp"

namespace thimble::world::cam {
namespace {

using Overlaps = std::function<bool(const CamAxes&)>;

struct Walk {
  CamAxes end{};
  int looks{0};
  int returns{0};
};

// Plays a search on a world that says what overlaps.
Walk walk(SearchKind kind, const CamAxes& desired, const Overlaps& overlaps) {
  PieceSearch search(kind, desired);
  CamAxes at{};
  Walk walk;
  while (const auto shift = search.next()) {
    for (std::size_t axis = 0; axis < 3; ++axis) at[axis] += shift->cells[axis];
    if (shift->is_looked_at) {
      ++walk.looks;
      search.take(overlaps(at) ? 1 : 0);
    } else {
      ++walk.returns;
      EXPECT_FALSE(overlaps(at)) << "it goes back only to where it was free";
    }
    if (walk.looks > 10'000) {
      ADD_FAILURE() << "no end";
      break;
    }
  }
  EXPECT_EQ(search.actual(), at) << "the shape stands where the search says";
  walk.end = at;
  return walk;
}

TEST(PieceSearch, WhereNothingIsItGetsThereInAsFewLooksAsTheThesisSays) {
  const Overlaps nothing = [](const CamAxes&) { return false; };
  const Walk one = walk(SearchKind::OneCell, {35, 0, 0}, nothing);
  EXPECT_EQ(one.end, (CamAxes{35, 0, 0}));
  EXPECT_EQ(one.looks, 35);
  EXPECT_EQ(one.returns, 0);
  const Walk leap = walk(SearchKind::Leap, {-35, 6, -1}, nothing);
  EXPECT_EQ(leap.end, (CamAxes{-35, 6, -1}));
  EXPECT_EQ(leap.looks, (8 + 3) + (1 + 2) + 1);
  EXPECT_EQ(walk(SearchKind::Leap, {}, nothing).looks, 0);
}

// Four, two, then one more or less.
TEST(PieceSearch, AWallIsFoundByHalves) {
  for (int free = 0; free < 12; ++free) {
    const Overlaps wall = [&](const CamAxes& at) { return at[1] > free; };
    const Walk leap = walk(SearchKind::Leap, {0, 20, 0}, wall);
    EXPECT_EQ(leap.end, (CamAxes{0, free, 0}));
    // The attempt that is cut short, and the one that finds nothing more.
    EXPECT_LE(leap.looks, free / 4 + 3 + 3);
    EXPECT_EQ(walk(SearchKind::OneCell, {0, 20, 0}, wall).end, (CamAxes{0, free, 0}));
  }
}

TEST(PieceSearch, ThickWallsStopBothKindsAtTheSamePlace) {
  std::mt19937 random(3);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  for (int i = 0; i < 2000; ++i) {
    // Cells of 4 x 4 x 4 blocks, of which the one around the start is free.
    std::set<CamAxes> blocks;
    for (int n = below(200); n > 0; --n) blocks.insert({below(9) - 4, below(9) - 4, below(9) - 4});
    blocks.erase({0, 0, 0});
    const auto block = [](int n) { return (n + 400) / 4 - 100; };
    const Overlaps overlaps = [&](const CamAxes& at) {
      return blocks.contains({block(at[0]), block(at[1]), block(at[2])});
    };
    const CamAxes desired{below(31) - 15, below(31) - 15, below(31) - 15};
    const CamAxes expected = test::greedy_walk(desired, overlaps);
    EXPECT_EQ(walk(SearchKind::OneCell, desired, overlaps).end, expected);
    EXPECT_EQ(walk(SearchKind::Leap, desired, overlaps).end, expected);
  }
}

TEST(PieceSearch, WhatIsThinnerThanALeapMayBeLeaptOverByLeapsAlone) {
  const Overlaps sheet = [](const CamAxes& at) { return at[0] == 2; };
  EXPECT_EQ(walk(SearchKind::OneCell, {8, 0, 0}, sheet).end, (CamAxes{1, 0, 0}));
  EXPECT_EQ(walk(SearchKind::Leap, {8, 0, 0}, sheet).end, (CamAxes{8, 0, 0}));
}

}  // namespace
}  // namespace thimble::world::cam
