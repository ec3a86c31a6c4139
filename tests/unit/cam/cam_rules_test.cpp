#include <gtest/gtest.h>

#include <array>
#include <bit>

#include "tests/unit/cam/cam_bench.hpp"

// Canonical rules on the reference board, each by what is known of it.
namespace thimble::cambus {
namespace {

using test::CamBench;
using test::Cells;
using test::Layout;

constexpr Layout kOneModule{{0, 0, 0}, {4, 4, 0}, Division::Mesh};
constexpr Layout kFourModules{{1, 1, 0}, {4, 4, 0}, Division::Mesh};
constexpr Layout kEightModules{{1, 1, 1}, {4, 4, 0}, Division::StripY};

std::uint32_t bit(std::uint32_t cell, int layer) { return (cell >> layer) & 1U; }

std::uint64_t population(const Cells& cells, std::uint16_t mask) {
  std::uint64_t count = 0;
  for (const std::uint16_t cell : cells) {
    count += static_cast<std::uint64_t>(std::popcount(std::uint32_t{cell} & mask));
  }
  return count;
}

class Rules : public testing::TestWithParam<Layout> {};
INSTANTIATE_TEST_SUITE_P(Layouts, Rules, testing::Values(kOneModule, kFourModules, kEightModules));

// --- Life: layer 0 lives; its copies in 1 to 8 are kicked to the neighbours.

const std::vector<LayerKick> kToNeighbors{
    {1U << 1, {-1, -1, 0}}, {1U << 2, {0, -1, 0}}, {1U << 3, {1, -1, 0}}, {1U << 4, {-1, 0, 0}},
    {1U << 5, {1, 0, 0}},   {1U << 6, {-1, 1, 0}}, {1U << 7, {0, 1, 0}},  {1U << 8, {1, 1, 0}}};

std::uint32_t life_rule(std::uint32_t cell) {
  const int neighbors = std::popcount(cell & 0x1feU);
  const bool lives = neighbors == 3 || (neighbors == 2 && bit(cell, 0) != 0);
  return lives ? 0x1ffU : 0;
}

Cells with_copies(Cells cells) {
  for (auto& cell : cells) cell = (cell & 1U) != 0 ? 0x1ff : 0;
  return cells;
}

// Every neighbour counted, cell by cell.
Cells plain_life(const CamBench& bench, const Cells& cells) {
  Cells after(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Axes at = bench.cell_at(i);
    int neighbors = -(cells[i] & 1);
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        neighbors += cells[bench.index_of({at[0] + dx, at[1] + dy, 0})] & 1;
      }
    }
    const bool lives = neighbors == 3 || (neighbors == 2 && (cells[i] & 1) != 0);
    after[i] = lives ? 0x1ff : 0;
  }
  return after;
}

TEST_P(Rules, LifeIsLife) {
  std::mt19937 random(11);
  CamBench bench(GetParam());
  Cells cells = with_copies(test::random_cells(bench.cell_count(), 1, random));
  bench.load(life_rule);
  bench.put(cells);
  for (int i = 0; i < 10; ++i) {
    bench.step(kToNeighbors);
    cells = plain_life(bench, cells);
    ASSERT_EQ(bench.get(), cells) << i;
  }
}

TEST_P(Rules, AGliderGoesAroundTheTorus) {
  CamBench bench(GetParam());
  Cells cells(bench.cell_count());
  for (const Axes& at :
       {Axes{1, 0, 0}, Axes{2, 1, 0}, Axes{0, 2, 0}, Axes{1, 2, 0}, Axes{2, 2, 0}}) {
    cells[bench.index_of(at)] = 0x1ff;
  }
  bench.load(life_rule);
  bench.put(cells);
  bench.step(kToNeighbors, 4);
  Cells moved(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Axes at = bench.cell_at(i);
    moved[bench.index_of({at[0] + 1, at[1] + 1, 0})] = cells[i];
  }
  EXPECT_EQ(bench.get(), moved);
  bench.step(kToNeighbors, 4 * 15);
  EXPECT_EQ(bench.get(), cells);
}

// --- HPP gas: layers 0 to 3 go to -y, +y, +x, -x; a lone head-on pair turns.

const std::vector<LayerKick> kHppMoves{
    {1, {0, -1, 0}}, {2, {0, 1, 0}}, {4, {1, 0, 0}}, {8, {-1, 0, 0}}};

std::uint32_t hpp_collide(std::uint32_t cell) {
  const std::uint32_t gas = cell & 0xfU;
  const std::uint32_t after = gas == 0x3 ? 0xcU : gas == 0xc ? 0x3U : gas;
  return (cell & ~0xfU) | after;
}
std::uint32_t hpp_reverse(std::uint32_t cell) {
  return (cell & 1U) << 1 | (cell & 2U) >> 1 | (cell & 4U) << 1 | (cell & 8U) >> 1;
}

struct Momentum {
  std::uint64_t particles;
  std::vector<std::int64_t> x_of_row, y_of_column;
  bool operator==(const Momentum&) const = default;
};

// Also what HPP keeps and no real gas does: momentum of each row along x, of each column along y.
Momentum momentum_of(const CamBench& bench, const Cells& cells) {
  Momentum sum{population(cells, 0xf), std::vector<std::int64_t>(16),
               std::vector<std::int64_t>(16)};
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Axes at = bench.cell_at(i);
    sum.x_of_row[static_cast<std::size_t>(at[1])] += int(bit(cells[i], 2)) - int(bit(cells[i], 3));
    sum.y_of_column[static_cast<std::size_t>(at[0])] +=
        int(bit(cells[i], 1)) - int(bit(cells[i], 0));
  }
  return sum;
}

TEST_P(Rules, HppKeepsParticlesAndMomentumAndRunsBack) {
  std::mt19937 random(12);
  CamBench bench(GetParam());
  const Cells start = test::random_cells(bench.cell_count(), 0xf, random);
  const Momentum kept = momentum_of(bench, start);
  bench.put(start);
  bench.load(hpp_collide);
  bench.step(kHppMoves, 30);
  EXPECT_EQ(momentum_of(bench, bench.get()), kept);
  // Move and collide, so many times; turned round, it collides first: one move apart.
  bench.load(hpp_reverse);
  bench.step({});
  bench.load(hpp_collide);
  bench.step({});
  bench.step(kHppMoves, 29);
  bench.load(test::identity);
  bench.step(kHppMoves);
  bench.load(hpp_reverse);
  bench.step({});
  EXPECT_EQ(bench.get(), start);
}

TEST_P(Rules, ALoneParticleComesBackAfterTheLengthOfTheTorus) {
  CamBench bench(GetParam());
  Cells cells(bench.cell_count());
  cells[bench.index_of({7, 3, 0})] = 4;
  bench.put(cells);
  bench.load(hpp_collide);
  bench.step(kHppMoves, 15);
  EXPECT_NE(bench.get(), cells);
  bench.step(kHppMoves);
  EXPECT_EQ(bench.get(), cells);
}

// --- Second order: layer 0 is now, 1 the past, 2 to 5 copies of now for the neighbours.

const std::vector<LayerKick> kToFour{
    {4, {0, -1, 0}}, {8, {0, 1, 0}}, {16, {1, 0, 0}}, {32, {-1, 0, 0}}};

std::uint32_t time_tunnel(std::uint32_t cell) {
  const int sum = std::popcount(cell & 0x3dU);
  const std::uint32_t table = sum >= 1 && sum <= 4 ? 1 : 0;
  const std::uint32_t next = table ^ bit(cell, 1);
  return next * 0x3dU | bit(cell, 0) << 1;
}
// The past becomes now and now the past.
std::uint32_t turn_round(std::uint32_t cell) { return bit(cell, 1) * 0x3dU | bit(cell, 0) << 1; }

TEST_P(Rules, ASecondOrderRuleRunsBack) {
  std::mt19937 random(13);
  CamBench bench(GetParam());
  Cells start(bench.cell_count());
  for (auto& cell : start) {
    cell = static_cast<std::uint16_t>((random() % 2) * 0x3d + 2 * (random() % 2));
  }
  bench.put(start);
  bench.load(time_tunnel);
  bench.step(kToFour, 40);
  EXPECT_NE(bench.get(), start);
  bench.load(turn_round);
  bench.step({});
  bench.load(time_tunnel);
  bench.step(kToFour, 40);
  bench.load(turn_round);
  bench.step({});
  EXPECT_EQ(bench.get(), start);
}

// --- Q2R: spin 0 and its copies 2 to 5, and which of a checkerboard's halves has its turn, 1.

std::uint32_t q2r(std::uint32_t cell) {
  const bool is_turn = bit(cell, 1) != 0;
  const bool flips = is_turn && std::popcount(cell & 0x3cU) == 2;
  const std::uint32_t spin = bit(cell, 0) ^ (flips ? 1U : 0U);
  return spin * 0x3dU | (is_turn ? 0U : 2U);
}

std::int64_t bonds(const CamBench& bench, const Cells& cells) {
  std::int64_t unequal = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Axes at = bench.cell_at(i);
    unequal += (cells[i] ^ cells[bench.index_of({at[0] + 1, at[1], 0})]) & 1;
    unequal += (cells[i] ^ cells[bench.index_of({at[0], at[1] + 1, 0})]) & 1;
  }
  return unequal;
}

TEST_P(Rules, Q2rKeepsItsEnergy) {
  std::mt19937 random(14);
  CamBench bench(GetParam());
  Cells start(bench.cell_count());
  for (std::size_t i = 0; i < start.size(); ++i) {
    const Axes at = bench.cell_at(i);
    start[i] = static_cast<std::uint16_t>((random() % 3 == 0 ? 0x3d : 0) |
                                          ((at[0] + at[1]) % 2 != 0 ? 2 : 0));
  }
  bench.put(start);
  bench.load(q2r);
  for (int i = 0; i < 4; ++i) {
    bench.step(kToFour, 8);
    EXPECT_EQ(bonds(bench, bench.get()), bonds(bench, start));
  }
  EXPECT_NE(bench.get(), start);
}

// --- Parity in three dimensions: whatever it starts from, 2^(n-1) steps leave nothing.

TEST(ParityRule, DiesOutOnEveryBoard) {
  const std::vector<LayerKick> kicks{{1, {1, 0, 0}},  {2, {-1, 0, 0}}, {4, {0, 1, 0}},
                                     {8, {0, -1, 0}}, {16, {0, 0, 1}}, {32, {0, 0, -1}}};
  for (const Layout& layout :
       {Layout{{0, 0, 0}, {3, 3, 3}, Division::Mesh}, Layout{{1, 1, 1}, {3, 3, 3}, Division::Mesh},
        Layout{{1, 1, 0}, {3, 3, 3}, Division::StripZ}}) {
    std::mt19937 random(15);
    CamBench bench(layout);
    Cells cells(bench.cell_count());
    for (auto& cell : cells) cell = static_cast<std::uint16_t>((random() % 2) * 0x3f);
    bench.put(cells);
    bench.load([](std::uint32_t cell) {
      return static_cast<std::uint32_t>(std::popcount(cell & 0x3fU) % 2) * 0x3fU;
    });
    bench.step(kicks, 3);
    EXPECT_NE(population(bench.get(), 0x3f), 0U) << test::to_string(layout);
    bench.step(kicks);
    EXPECT_EQ(population(bench.get(), 0x3f), 0U) << test::to_string(layout);
  }
}

// --- A gas of six directions in three dimensions: a lone pair turns to the next axis.

TEST(ThreeDimensionalGas, KeepsParticlesAndMomentum) {
  const std::vector<LayerKick> kicks{{1, {1, 0, 0}},  {2, {-1, 0, 0}}, {4, {0, 1, 0}},
                                     {8, {0, -1, 0}}, {16, {0, 0, 1}}, {32, {0, 0, -1}}};
  const auto momentum = [](const Cells& cells) {
    std::array<std::uint64_t, 4> sum{population(cells, 0x3f)};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto forward = static_cast<std::uint16_t>(1U << (2 * axis));
      const auto back = static_cast<std::uint16_t>(2U << (2 * axis));
      sum[1 + axis] = population(cells, forward) - population(cells, back);
    }
    return sum;
  };
  std::mt19937 random(16);
  CamBench bench({{1, 1, 1}, {3, 3, 3}, Division::Mesh});
  const Cells start = test::random_cells(bench.cell_count(), 0x3f, random);
  bench.put(start);
  bench.load([](std::uint32_t cell) {
    return cell == 0x03 ? 0x0cU : cell == 0x0c ? 0x30U : cell == 0x30 ? 0x03U : cell;
  });
  bench.step(kicks, 20);
  EXPECT_NE(bench.get(), start);
  EXPECT_EQ(momentum(bench.get()), momentum(start));
}

}  // namespace
}  // namespace thimble::cambus
