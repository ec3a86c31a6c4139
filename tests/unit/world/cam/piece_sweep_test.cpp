#include "daemon/world/cam/piece_sweep.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <random>
#include <set>

#include "tests/unit/world/cam/greedy_walk.hpp"
#include "tests/unit/world/cam/piece_bench.hpp"
#include "tests/unit/world/cam/piece_oracle.hpp"

namespace thimble::world::cam {
namespace {

using Overlaps = std::function<bool(const CamAxes&)>;

struct Walk {
  CamAxes end{};
  int scans{0};
};

CamAxes plus(const CamAxes& a, const CamAxes& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }

// Plays a search on a world that says what overlaps, by a trail that is a list of places.
Walk walk(const CamAxes& desired, const CamAxes& longest, const Overlaps& overlaps) {
  SweepSearch search(desired, longest);
  CamAxes at{};
  Walk walk;
  while (const auto round = search.next()) {
    at = plus(at, round->shift);
    EXPECT_EQ(search.stands(), at);
    EXPECT_FALSE(overlaps(at)) << "it stands only where it is free";
    ++walk.scans;
    std::set<CamAxes> trail{at};
    std::optional<SweepSearch::Hit> hit;
    for (std::size_t i = 0; i < round->kicks.size(); ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_LE(std::abs(round->kicks[i][axis]), longest[axis]);
        EXPECT_LE(std::abs(round->shift[axis]), longest[axis]);
      }
      std::set<CamAxes> ahead;
      for (const CamAxes& place : trail) ahead.insert(plus(place, round->kicks[i]));
      trail.merge(ahead);
      ++walk.scans;
      const auto met = std::count_if(trail.begin(), trail.end(), overlaps);
      if (met > 0 && !hit) hit = {i, static_cast<int>(met)};
    }
    search.take(hit);
    if (walk.scans > 10'000) {
      ADD_FAILURE() << "no end";
      break;
    }
  }
  walk.end = plus(at, search.owed());
  return walk;
}

TEST(SweepSearch, NothingIsTooThinToStopIt) {
  std::mt19937 random(3);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  for (int i = 0; i < 4000; ++i) {
    std::set<CamAxes> matter;  // single cells, and sheets of one cell's thickness
    for (int n = below(60); n > 0; --n) matter.insert({below(25) - 12, below(25) - 12, below(3)});
    const std::size_t across = random() % 3;
    const int sheet = below(25) - 12;
    const Overlaps overlaps = [&](const CamAxes& at) {
      return at != CamAxes{} && (matter.contains(at) || (sheet != 0 && at[across] == sheet));
    };
    const CamAxes desired{below(41) - 20, below(41) - 20, below(5) - 2};
    const CamAxes longest{1 + below(64), 1 + below(64), 1 + below(8)};
    EXPECT_EQ(walk(desired, longest, overlaps).end, test::greedy_walk(desired, overlaps));
  }
}

// A leap takes 8 + 3 for this way.
TEST(SweepSearch, AFreeWayTakesAScanForEachTimeItDoubles) {
  const Overlaps nothing = [](const CamAxes&) { return false; };
  EXPECT_EQ(walk({35, 0, 0}, {64, 64, 64}, nothing).scans, 1 + 6);
  EXPECT_EQ(walk({0, -7, 0}, {64, 64, 64}, nothing).scans, 1 + 3);
  EXPECT_EQ(walk({}, {64, 64, 64}, nothing).scans, 0);
  const Overlaps wall = [](const CamAxes& at) { return at[0] == 20; };
  EXPECT_LE(walk({35, 0, 0}, {64, 64, 64}, wall).scans, 7 + 5 + 4 + 2);
}

// Walls of one cell, through the tables and a board: where leaps go through, the trail does not.
TEST(SweepOnABoard, NeverPassesAWallOfOneCell) {
  constexpr CamGeometry kSpace{{5, 5, 0}, CamDivision::StripY};
  std::mt19937 random(9);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  int leapt = 0;
  for (int round = 0; round < 12; ++round) {
    PieceLayout layout(kSpace.cells());
    for (int wall = 1; wall <= 4; ++wall) {
      const int across = below(32);
      for (int along = 0; along < 32; ++along) {
        if (along == below(200)) continue;  // seldom a gap
        const CamAxes at = wall % 2 == 0 ? CamAxes{across, along, 0} : CamAxes{along, across, 0};
        layout[index_of(kSpace, at)] = static_cast<std::uint8_t>(wall);
      }
    }
    const CamAxes start{below(32), below(32), 0};
    layout[index_of(kSpace, start)] = 0;
    test::PieceBench sweep({.space = kSpace, .search = SearchKind::Sweep}, layout, start,
                           {{2, 2, 1}, 8});
    test::PieceBench bounded({.space = kSpace, .search = SearchKind::BoundedSweep}, layout, start,
                             {{2, 2, 1}, 8});
    test::PieceBench leap({.space = kSpace, .search = SearchKind::Leap}, layout, start,
                          {{2, 2, 1}, 8});
    test::PieceOracle oracle(kSpace, layout, start);
    for (int i = 0; i < 12; ++i) {
      const CamAxes way{below(32) - oracle.grasp()[0], below(32) - oracle.grasp()[1], 0};
      sweep.board().move(way);
      sweep.pump();
      bounded.board().move(way);
      bounded.pump();
      leap.board().move(way);
      leap.pump();
      oracle.move(way);
      ASSERT_EQ(sweep.board().state().grasp, oracle.grasp()) << round << ' ' << i;
      ASSERT_EQ(bounded.board().state(), sweep.board().state()) << round << ' ' << i;
      leapt += leap.board().state().grasp != oracle.grasp() ? 1 : 0;
    }
    EXPECT_EQ(sweep.board().counters().failures, 0U);
    EXPECT_EQ(bounded.board().counters().failures, 0U);
  }
  EXPECT_GT(leapt, 0) << "else it was no trial";
}

// Strips along y divide no other axis: there one round is as long as it has to be.
TEST(SweepOnABoard, AxesThatAreNotDividedAreGoneInOneRound) {
  constexpr CamGeometry kSpace{{5, 5, 5}, CamDivision::StripY};
  const auto programs_of = [&](const CamAxes& way) {
    test::PieceBench bench({.space = kSpace, .search = SearchKind::Sweep},
                           PieceLayout(kSpace.cells()), {4, 4, 4}, {{2, 2, 2}, 12});
    const auto before = bench.board().counters().programs;
    bench.board().move(way);
    bench.pump();
    EXPECT_EQ(bench.board().state().grasp, (CamAxes{4 + way[0], 4 + way[1], 4 + way[2]}));
    return bench.board().counters().programs - before;
  };
  EXPECT_EQ(programs_of({20, 0, 0}), 2U);
  EXPECT_EQ(programs_of({0, 0, 20}), 2U);
  EXPECT_EQ(programs_of({0, 20, 0}), 1U + 20 / 4) << "a module has four rows";
}

// Pieces that are carried over edges of the space and of modules, among sheets of one cell: what is
// found within a box is what is found in the whole, in all that is known of it, and sooner.
TEST(BoundedSweepOnABoard, FindsWhatTheWholeSpaceDoesInFewerClocks) {
  struct Case {
    CamGeometry space;
    sim::cam::TorusShape board;
  };
  for (const Case& of : {Case{{{7, 6, 0}, CamDivision::StripY}, {{2, 2, 1}, 11}},
                         Case{{{5, 5, 4}, CamDivision::StripY}, {{2, 1, 1}, 13}},
                         Case{{{4, 5, 5}, CamDivision::Mesh}, {{1, 1, 1}, 14}}}) {
    std::mt19937 random(21);
    const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
    const CamAxes size = cells_along(of.space);
    PieceLayout layout = random_layout(of.space, 4, 3).value();
    for (std::size_t i = 0; i < layout.size(); i += 173) {
      if (layout[i] == 0) layout[i] = static_cast<std::uint8_t>(5 + i % 50);
    }
    const auto found = std::find(layout.begin(), layout.end(), 2) - layout.begin();
    const CamAxes start{static_cast<int>(found % size[0]),
                        static_cast<int>(found / size[0] % size[1]),
                        static_cast<int>(found / size[0] / size[1])};
    test::PieceBench whole({.space = of.space, .search = SearchKind::Sweep}, layout, start,
                           of.board);
    test::PieceBench bounded({.space = of.space, .search = SearchKind::BoundedSweep}, layout, start,
                             of.board);
    test::PieceOracle oracle(of.space, layout, start);
    std::uint64_t clocks = 0;
    std::uint64_t clocks_of_whole = 0;
    for (int i = 0; i < 40; ++i) {
      if (i % 10 == 0) {
        const auto action = oracle.held() == 0 ? PieceAction::Select : PieceAction::Drop;
        whole.board().act(action, {});
        bounded.board().act(action, {});
        static_cast<void>(oracle.act(action, {}));
      }
      whole.pump();
      bounded.pump();
      CamAxes way{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const int to = std::clamp(oracle.grasp()[axis] + below(15) - 7, 0, size[axis] - 1);
        way[axis] = to - oracle.grasp()[axis];
      }
      const std::uint64_t before = bounded.clocks();
      const std::uint64_t before_of_whole = whole.clocks();
      whole.board().move(way);
      whole.pump();
      bounded.board().move(way);
      bounded.pump();
      oracle.move(way);
      clocks += bounded.clocks() - before;
      clocks_of_whole += whole.clocks() - before_of_whole;
      ASSERT_EQ(bounded.board().state(), whole.board().state()) << i;
      ASSERT_EQ(bounded.board().state().grasp, oracle.grasp()) << i;
      ASSERT_EQ(bounded.board().state().touching, oracle.touching()) << i;
      CamCells cells = bounded.cells();
      for (auto& bits : cells) bits &= cell::kPart | cell::kMoving;
      ASSERT_EQ(cells, oracle.cells()) << i;
    }
    EXPECT_LT(clocks, clocks_of_whole);
    EXPECT_EQ(bounded.board().counters().failures, 0U);
  }
}

}  // namespace
}  // namespace thimble::world::cam
