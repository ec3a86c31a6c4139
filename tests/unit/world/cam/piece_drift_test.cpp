#include "daemon/world/cam/piece_drift.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <random>

#include "tests/unit/world/cam/piece_bench.hpp"

// Particles of dynamic pieces (thesis 4.2.4).
namespace thimble::world::cam {
namespace {

using test::PieceBench;

// As the page of the rules has them.
constexpr unsigned kShapeBit = 1U << 1;
constexpr unsigned kOverlapBit = 1U << 3;
constexpr unsigned kForthBit = 1U << 7;
constexpr unsigned kBackBit = 1U << 8;
constexpr unsigned kDiceBit = 1U << 9;
constexpr unsigned kBeside = kForthBit | kBackBit | kDiceBit;
constexpr unsigned kHighSelect = 7U << 13;
constexpr unsigned kNotSelect = (1U << 10) - 1;
constexpr unsigned kDriftBit = 1U << 13;
constexpr unsigned kEmitBit = 1U << 14;

// What a drift does to the three bits of a cell.
unsigned drifted(unsigned cell, bool is_emitting) {
  const bool is_dice = (cell & kDiceBit) != 0;
  const bool is_shape = (cell & kShapeBit) != 0;
  bool forth = (cell & kForthBit) != 0;
  bool back = (cell & kBackBit) != 0;
  if ((cell >> 4 & 7U) != 0) {
    forth = back = false;
  } else if (is_dice) {
    std::swap(forth, back);
    if (is_shape && is_emitting) forth = back = true;
  }
  return (forth ? kForthBit : 0) | (back ? kBackBit : 0) | (is_dice ? kDiceBit : 0);
}

TEST(DynamicRules, AreTheStaticOnesBesideWhatDrifts) {
  const PieceTables still = make_piece_tables();
  const PieceTables sut = make_piece_tables(true);
  const std::pair<const CamTable&, const CamTable&> tables[] = {{*sut.overlap, *still.overlap},
                                                                {*sut.grasp, *still.grasp},
                                                                {*sut.select, *still.select},
                                                                {*sut.deposit, *still.deposit},
                                                                {*sut.sweep, *still.sweep}};
  for (const auto& [table, of_still] : tables) {
    for (unsigned n = 0; n < 65'536; ++n) {
      const unsigned pieces = of_still[n & ~kBeside] & ~(kBeside | kHighSelect);
      ASSERT_EQ(table[n] & ~kBeside, pieces) << n;
      unsigned beside = n & kBeside;
      if (&table == sut.overlap.get() && (n & kDriftBit) != 0) {
        beside = drifted(n, (n & kEmitBit) != 0);
      }
      const bool is_deleted = (n & 2U) != 0 && n >> 10 == 0;
      if (&table == sut.deposit.get() && is_deleted) beside |= kForthBit | kBackBit;
      ASSERT_EQ(table[n] & kBeside, beside) << n;
    }
  }
}

TEST(DriftKicks, TakeTheAxesThatThereAreByTurnsAndTheDiceAnywhere) {
  const CamAxes longest{32, 4, 1};
  CamAxes least{};
  CamAxes most{};
  for (std::uint64_t n = 0; n < 1000; ++n) {
    const DriftKicks plane = drift_kicks(n, {{5, 5, 0}, {}}, longest);
    EXPECT_EQ(plane.forth, (CamAxes{n % 2 == 0 ? 1 : 0, n % 2 == 0 ? 0 : 1, 0}));
    EXPECT_EQ(plane.dice[2], 0);
    const DriftKicks space = drift_kicks(n, {{5, 5, 5}, {}}, longest);
    EXPECT_EQ(space.forth[n % 3], 1);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      least[axis] = std::min(least[axis], space.dice[axis]);
      most[axis] = std::max(most[axis], space.dice[axis]);
    }
  }
  EXPECT_EQ(least, (CamAxes{-32, -4, -1}));
  EXPECT_EQ(most, (CamAxes{32, 4, 1}));
}

struct Setting {
  const char* name;
  CamGeometry space;
  sim::cam::TorusShape board;
  SearchKind search{SearchKind::Sweep};
};
void PrintTo(const Setting& setting, std::ostream* out) { *out << setting.name; }

class ParticlesOnABoard : public testing::TestWithParam<Setting> {
 protected:
  // The index of the cell that what came by `kick` came from.
  [[nodiscard]] static std::size_t origin_of(std::size_t index, const CamAxes& kick) {
    const CamAxes size = cells_along(GetParam().space);
    CamAxes cell{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int at = static_cast<int>(index % static_cast<std::size_t>(size[axis]));
      index /= static_cast<std::size_t>(size[axis]);
      cell[axis] = (at - kick[axis] + 2 * size[axis]) % size[axis];
    }
    return index_of(GetParam().space, cell);
  }
  [[nodiscard]] static CamCells after_drift(const CamCells& before, std::uint64_t n, int modules,
                                            bool is_held) {
    CamAxes longest = cells_along(GetParam().space);
    const bool is_strip = GetParam().space.division == CamDivision::StripY;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!is_strip || axis == 1) longest[axis] = std::max(longest[axis] / modules, 1);
    }
    const DriftKicks kicks = drift_kicks(n, GetParam().space, longest);
    const CamAxes back{-kicks.forth[0], -kicks.forth[1], -kicks.forth[2]};
    CamCells after(before.size());
    for (std::size_t i = 0; i < after.size(); ++i) {
      unsigned cell = before[i] & ~kBeside;
      cell |= before[origin_of(i, kicks.forth)] & kForthBit;
      cell |= before[origin_of(i, back)] & kBackBit;
      cell |= before[origin_of(i, kicks.dice)] & kDiceBit;
      // A drift is a scan that also marks where the shape lies on a piece, as each does.
      const bool overlaps = (cell & kShapeBit) != 0 && (cell >> 4 & 7U) != 0;
      cell = (cell & ~kOverlapBit) | (overlaps ? kOverlapBit : 0);
      after[i] = static_cast<std::uint16_t>((cell & ~kBeside) | drifted(cell, is_held));
    }
    return after;
  }
  [[nodiscard]] static std::size_t particles_in(const CamCells& cells) {
    std::size_t count = 0;
    for (const unsigned bits : cells) {
      count += static_cast<std::size_t>(std::popcount(bits & (kForthBit | kBackBit)));
    }
    return count;
  }
};

// Whatever is done to the pieces meanwhile.
TEST_P(ParticlesOnABoard, DriftCellForCellAsInAPlainArray) {
  const Setting& setting = GetParam();
  std::mt19937 random(4);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  const PieceLayout layout = random_layout(setting.space, 4, 2).value();
  const CamAxes size = cells_along(setting.space);
  // In piece 3, so that there is something to hold at once.
  const auto found = std::find(layout.begin(), layout.end(), 3) - layout.begin();
  const CamAxes grasp{static_cast<int>(found % size[0]),
                      static_cast<int>(found / size[0] % size[1]),
                      static_cast<int>(found / size[0] / size[1])};
  PieceBench bench({.space = setting.space, .search = setting.search, .is_dynamic = true}, layout,
                   grasp, setting.board);
  const auto modules = static_cast<int>(setting.board.modules[0] * setting.board.modules[1] *
                                        setting.board.modules[2]);
  EXPECT_EQ(particles_in(bench.cells()), 0U);
  std::size_t most = 0;
  for (int i = 0; i < 80; ++i) {
    const PieceState& state = bench.board().state();
    if (i % 4 == 3) {
      const CamAxes way{below(7) - 3, below(7) - 3, setting.space.log2_cells[2] > 0 ? 1 : 0};
      bench.board().move(way);
    } else if (i % 8 == 0) {
      const bool is_deleted = i % 32 == 24;
      bench.board().act(state.held == 0 ? PieceAction::Select
                        : is_deleted    ? PieceAction::Delete
                                        : PieceAction::Drop,
                        {});
    }
    bench.pump();
    const CamCells before = bench.cells();
    const std::uint64_t n = bench.board().counters().drifts;
    const bool is_held = state.held != 0;
    bench.board().drift();
    bench.pump();
    const CamCells expected = after_drift(before, n, modules, is_held);
    const CamCells after = bench.cells();
    for (std::size_t at = 0; at < after.size(); ++at) {
      ASSERT_EQ(after[at] & kNotSelect, expected[at] & kNotSelect) << i << ' ' << at;
    }
    ASSERT_EQ(bench.board().counters().drifts, n + 1);
    most = std::max(most, particles_in(before));
  }
  EXPECT_GT(most, 50U);
}

TEST_P(ParticlesOnABoard, ADeletedPieceIsACloudThatSpreadsAndIsNotLost) {
  const Setting& setting = GetParam();
  PieceLayout layout(setting.space.cells());
  const CamAxes size = cells_along(setting.space);
  const CamAxes middle{size[0] / 2, size[1] / 2, size[2] / 2};
  for (int x = 0; x < 4; ++x)
    layout[index_of(setting.space, {middle[0] + x, middle[1], middle[2]})] = 5;
  PieceBench bench({.space = setting.space, .is_dynamic = true}, layout, middle, setting.board);
  for (const auto action : {PieceAction::Select, PieceAction::Delete}) {
    bench.board().act(action, {});
    bench.pump();
  }
  ASSERT_EQ(bench.board().take_outcome(), PieceOutcome::Deleted);
  EXPECT_EQ(particles_in(bench.cells()), 8U);
  std::size_t places = 0;
  for (int i = 0; i < 40; ++i) {
    bench.board().drift();
    bench.pump();
    const CamCells cells = bench.cells();
    ASSERT_EQ(particles_in(cells), 8U) << i;
    places = static_cast<std::size_t>(std::count_if(cells.begin(), cells.end(), [](unsigned bits) {
      return (bits & (kForthBit | kBackBit)) != 0;
    }));
  }
  EXPECT_GT(places, 5U);
}

// They are lost then, and dice there are again; the pieces are where they were.
TEST_P(ParticlesOnABoard, AfterALostDriftPiecesAndDiceAreThere) {
  const Setting& setting = GetParam();
  PieceLayout layout(setting.space.cells());
  layout[index_of(setting.space, {3, 3, 0})] = 7;
  layout[index_of(setting.space, {4, 3, 0})] = 7;
  for (const bool is_done : {false, true}) {
    PieceBench bench({.space = setting.space, .is_dynamic = true}, layout, {3, 3, 0},
                     setting.board);
    const CamCells first = bench.cells();
    bench.board().act(PieceAction::Select, {});
    bench.pump();
    bench.board().move({2, 3, 0});
    bench.pump();
    for (int i = 0; i < 5; ++i) {
      bench.board().drift();
      bench.pump();
    }
    const CamCells before = bench.cells();
    EXPECT_GT(particles_in(before), 0U);
    bench.strike(1, is_done);
    bench.board().drift();
    bench.pump();
    EXPECT_EQ(bench.board().counters().repairs, 1U);
    EXPECT_EQ(bench.board().counters().resets, 0U);
    EXPECT_EQ(bench.board().counters().drifts, 5U);
    EXPECT_EQ(bench.board().state().held, 7);
    const CamCells after = bench.cells();
    for (std::size_t i = 0; i < after.size(); ++i) {
      ASSERT_EQ(after[i] & ~kBeside, before[i] & ~kBeside) << i;
      ASSERT_EQ(after[i] & kBeside, first[i] & kBeside) << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    World, ParticlesOnABoard,
    testing::Values(Setting{"Plane", {{5, 5, 0}, CamDivision::Mesh}, {{1, 1, 1}, 10}},
                    Setting{"PlaneOnFourModules", {{5, 5, 0}, CamDivision::StripY}, {{2, 2, 1}, 8}},
                    Setting{"PlaneInBoxes",
                            {{6, 6, 0}, CamDivision::StripY},
                            {{2, 2, 1}, 10},
                            SearchKind::BoundedSweep},
                    Setting{"Space", {{4, 4, 4}, CamDivision::StripY}, {{2, 1, 1}, 11}}),
    [](const auto& setting) { return setting.param.name; });

// Each axis has half of the drifts, a cell each: a variance of half as many cells.
TEST(ParticleCloud, SpreadsAsDiffusionDoes) {
  constexpr CamGeometry kPlane{{7, 7, 0}, CamDivision::StripY};
  constexpr int kDrifts = 60;
  PieceLayout layout(kPlane.cells());
  for (int y = 56; y < 72; ++y) {
    for (int x = 56; x < 72; ++x) layout[index_of(kPlane, {x, y, 0})] = 1;
  }
  PieceBench bench({.space = kPlane, .is_dynamic = true}, layout, {64, 64, 0}, {{2, 2, 1}, 12});
  for (const auto action : {PieceAction::Select, PieceAction::Delete}) {
    bench.board().act(action, {});
    bench.pump();
  }
  for (int i = 0; i < kDrifts; ++i) {
    bench.board().drift();
    bench.pump();
  }
  const CamCells cells = bench.cells();
  std::array<double, 2> sum{};
  std::array<double, 2> squares{};
  int count = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const int here = std::popcount(cells[i] & (kForthBit | kBackBit));
    const double at[] = {static_cast<double>(i % 128), static_cast<double>(i / 128)};
    count += here;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      sum[axis] += here * at[axis];
      squares[axis] += here * at[axis] * at[axis];
    }
  }
  ASSERT_EQ(count, 512);
  constexpr double kOfPiece = (16 * 16 - 1) / 12.0;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double mean = sum[axis] / count;
    EXPECT_NEAR(mean, 63.5, 1.5);
    EXPECT_NEAR(squares[axis] / count - mean * mean, kOfPiece + kDrifts / 2.0, 8);
  }
}

}  // namespace
}  // namespace thimble::world::cam
