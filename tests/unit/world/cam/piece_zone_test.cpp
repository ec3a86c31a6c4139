#include "daemon/world/cam/piece_zone.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "tests/unit/world/cam/piece_bench.hpp"
#include "tests/unit/world/cam/piece_oracle.hpp"

namespace thimble::world::cam {
namespace {

// Matter `wall` cells away, or nowhere; what is looked at by a round as the tables do it.
struct Looked {
  PieceZone::Way found{};
  int rounds{0};
  int kicks{0};
  int readings{0};
};
Looked look(FreeWay way, const std::vector<bool>& is_matter, int longest) {
  Looked looked;
  while (!way.is_over() && looked.rounds < 100) {
    std::vector<bool> trail(is_matter.size());
    trail[0] = true;
    std::optional<SweepSearch::Hit> hit;
    const FreeWay::Round round = way.next();
    const std::vector<int>& kicks = round.kicks;
    for (std::size_t i = 0; i < kicks.size(); ++i) {
      EXPECT_GE(kicks[i], 1);
      EXPECT_LE(kicks[i], longest);
      for (std::size_t at = trail.size(); at-- > static_cast<std::size_t>(kicks[i]);) {
        if (trail[at - static_cast<std::size_t>(kicks[i])]) trail[at] = true;
      }
      int cells = 0;
      for (std::size_t at = 0; at < trail.size(); ++at) cells += trail[at] && is_matter[at] ? 1 : 0;
      if (i >= round.counted && cells > 0 && !hit) hit = {i, cells};
      ++looked.kicks;
    }
    way.take(hit);
    looked.readings += static_cast<int>(kicks.size() - round.counted);
    ++looked.rounds;
  }
  looked.found = way.found();
  return looked;
}

TEST(FreeWay, FindsTheFirstThatIsNotFreeWhateverIsKnownOrExpected) {
  std::mt19937 random(5);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  for (int i = 0; i < 2'000; ++i) {
    const int most = below(40);
    std::vector<bool> is_matter(100);
    for (int n = below(4); n > 0; --n) is_matter[1 + random() % 60] = true;
    PieceZone::Way expected{most, 0};
    for (int at = 1; at <= most && expected.touching == 0; ++at) {
      if (is_matter[static_cast<std::size_t>(at)]) expected = {at - 1, 1};
    }
    const int longest = 1 + below(40);
    const int known = below(expected.free + 1);
    const Looked looked = look({most, longest, known, below(42) - 1}, is_matter, longest);
    ASSERT_EQ(looked.found, expected) << most << ' ' << longest << ' ' << known;
  }
}

TEST(FreeWay, TakesOneRoundWhereAllIsFreeOrAsItIsExpected) {
  std::vector<bool> is_matter(100);
  const Looked free = look({31, 64, 0, -1}, is_matter, 64);
  EXPECT_EQ(free.rounds, 1);
  EXPECT_EQ(free.kicks, 5) << "1, 2, 4, 8 and 16 cells";
  EXPECT_EQ(free.readings, 1);
  is_matter[20] = true;
  const Looked wall = look({31, 64, 0, 19}, is_matter, 64);
  EXPECT_EQ(wall.found, (PieceZone::Way{19, 1}));
  EXPECT_EQ(wall.rounds, 1);
  EXPECT_EQ(wall.kicks, 6) << "19 cells, and the one that stops it";
  EXPECT_EQ(wall.readings, 2);
}

struct Case {
  CamGeometry space;
  sim::cam::TorusShape board;
};
const std::vector<Case>& cases() {
  static const std::vector<Case> kCases{{{{7, 6, 0}, CamDivision::StripY}, {{2, 2, 1}, 11}},
                                        {{{5, 5, 4}, CamDivision::StripY}, {{2, 1, 1}, 13}},
                                        {{{4, 5, 5}, CamDivision::Mesh}, {{1, 1, 1}, 14}},
                                        {{{5, 5, 0}, CamDivision::StripY}, {{2, 2, 2}, 7}}};
  return kCases;
}

// Pieces, and single cells for a search that nothing is too thin for.
PieceLayout layout_at_random(const CamGeometry& space, bool has_thin, unsigned seed) {
  PieceLayout layout = random_layout(space, 4, seed).value();
  if (!has_thin) return layout;
  for (std::size_t i = seed; i < layout.size(); i += 97) {
    if (layout[i] == 0) layout[i] = static_cast<std::uint8_t>(5 + i % 50);
  }
  return layout;
}

CamAxes place_of(const CamGeometry& space, const PieceLayout& layout, int part) {
  const CamAxes size = cells_along(space);
  const auto found =
      static_cast<int>(std::find(layout.begin(), layout.end(), part) - layout.begin());
  return {found % size[0], found / size[0] % size[1], found / size[0] / size[1]};
}

// Moves, takes, carries and drops pieces, and looks around after each.
class Walk {
 public:
  Walk(const Case& of, SearchKind search, unsigned seed, bool is_dynamic = false)
      : of_(of),
        random_(seed),
        layout_(layout_at_random(of.space, search != SearchKind::Leap && !is_dynamic, seed)),
        start_(place_of(of.space, layout_, 2)),
        bench_({.space = of.space, .search = search, .is_dynamic = is_dynamic}, layout_, start_,
               of.board),
        oracle_(of.space, layout_, start_) {}

  void move() {
    const CamAxes size = cells_along(of_.space);
    CamAxes way{};
    const bool is_straight = random_() % 2 == 0;
    const std::size_t only = random_() % 3;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (is_straight && axis != only) continue;
      const int to = oracle_.grasp()[axis] + static_cast<int>(random_() % 15) - 7;
      way[axis] = std::clamp(to, 0, size[axis] - 1) - oracle_.grasp()[axis];
    }
    bench_.board().move(way);
    bench_.pump();
    oracle_.move(way);
    ASSERT_EQ(bench_.board().state().grasp, oracle_.grasp());
  }
  void take_or_drop() { act(oracle_.held() == 0 ? PieceAction::Select : PieceAction::Drop); }
  void act(PieceAction action) {
    bench_.board().act(action, {});
    bench_.pump();
    static_cast<void>(oracle_.act(action, {}));
  }
  // What it takes of the board.
  std::uint64_t look(int cells) {
    const PieceState before = bench_.board().state();
    const std::uint64_t clocks = bench_.clocks();
    bench_.board().look_around(cells);
    bench_.pump();
    EXPECT_EQ(bench_.board().zone(), oracle_.zone(cells));
    EXPECT_EQ(bench_.board().state(), before) << "nothing moves";
    return bench_.clocks() - clocks;
  }
  void expect_untouched() {
    CamCells cells = bench_.cells();
    for (auto& bits : cells) bits &= cell::kPart | cell::kMoving;
    EXPECT_EQ(cells, oracle_.cells());
    EXPECT_EQ(bench_.board().counters().failures, 0U);
  }
  [[nodiscard]] const test::PieceOracle& oracle() const { return oracle_; }
  [[nodiscard]] test::PieceBench& bench() { return bench_; }

 private:
  Case of_;
  std::mt19937 random_;
  PieceLayout layout_;
  CamAxes start_;
  test::PieceBench bench_;
  test::PieceOracle oracle_;
};

TEST(ZoneOnABoard, IsWhatAPlainArraySaysInPlanesAndInSpaceHeldPieceAndAll) {
  int looks_with_piece = 0;
  int looks = 0;
  for (const Case& of : cases()) {
    for (const SearchKind search :
         {SearchKind::BoundedSweep, SearchKind::Sweep, SearchKind::Leap}) {
      Walk walk(of, search, 3 + static_cast<unsigned>(search));
      for (int i = 0; i < 48; ++i) {
        if (i % 12 == 0) walk.take_or_drop();
        walk.move();
        if (walk.oracle().is_embedded()) continue;
        static_cast<void>(walk.look(1 + i % 2 * 20));
        ++looks;
        if (walk.oracle().held() != 0) ++looks_with_piece;
        if (HasFailure()) return;
      }
      walk.expect_untouched();
    }
  }
  EXPECT_GT(looks, 300);
  EXPECT_GT(looks_with_piece, 100);
}

TEST(ZoneOnABoard, HasNothingOfTheParticlesOfDynamicPieces) {
  for (const Case& of : {cases()[0], cases()[1]}) {
    Walk walk(of, SearchKind::BoundedSweep, 5, true);
    walk.act(PieceAction::Select);
    for (int i = 0; i < 30; ++i) {
      walk.bench().board().drift();
      walk.bench().pump();
      walk.move();
      static_cast<void>(walk.look(20));
      if (HasFailure()) return;
    }
    EXPECT_EQ(walk.bench().board().counters().drifts, 30U);
  }
}

TEST(ZoneOnABoard, TakesAFewClocksInTheBoxesOfItsTrails) {
  Walk in_boxes(cases()[2], SearchKind::BoundedSweep, 3);
  Walk in_all(cases()[2], SearchKind::Sweep, 3);
  for (Walk* const walk : {&in_boxes, &in_all}) {
    walk->act(PieceAction::Select);
    walk->act(PieceAction::Delete);
  }
  std::uint64_t clocks = 0;
  std::uint64_t clocks_in_all = 0;
  for (int i = 0; i < 20; ++i) {
    clocks += in_boxes.look(20);
    clocks_in_all += in_all.look(20);
    in_boxes.move();
    in_all.move();
  }
  EXPECT_LT(10 * clocks, clocks_in_all);
}

TEST(ZoneOnABoard, IsForgottenWhenPiecesMayHaveChanged) {
  Walk walk(cases()[0], SearchKind::BoundedSweep, 4);
  walk.take_or_drop();
  ASSERT_NE(walk.oracle().held(), 0);
  static_cast<void>(walk.look(20));
  ASSERT_TRUE(walk.bench().board().zone());
  walk.bench().board().act(PieceAction::Look, {});
  EXPECT_TRUE(walk.bench().board().zone());
  walk.bench().pump();
  walk.bench().board().act(PieceAction::Delete, {});
  EXPECT_FALSE(walk.bench().board().zone());
}

}  // namespace
}  // namespace thimble::world::cam
