#include <gtest/gtest.h>

#include <array>
#include <bit>

#include "tests/unit/cam/cam_bench.hpp"

// Rules of blocks of 2 x 2 (Margolus neighbourhood), and a gas on hexagons, each by what is known
// of it.
//
// A site is a block: layer 0 is its cell (0,0), 1 is (1,0), 2 is (0,1), 3 is (1,1). The blocks that
// lie across are made by kicks: cell (1,1) stays and becomes (0,0) of another block, and so on, so
// that a layer's cell is then the one opposite. All rules here are the same turned by 180 degrees,
// so a table does for both. Layer 4 says which of the two it is; layer 5 has random bits, which
// pass by.
namespace thimble::cambus {
namespace {

using test::CamBench;
using test::Cells;
using test::Layout;

constexpr std::uint32_t kBlock = 0xf;
constexpr std::uint32_t kPhase = 0x10;

const std::vector<LayerKick> kAcross{
    {1, {-1, -1, 0}}, {2, {0, -1, 0}}, {4, {-1, 0, 0}}, {0x20, {1, 2, 0}}};
const std::vector<LayerKick> kBack{
    {1, {1, 1, 0}}, {2, {0, 1, 0}}, {4, {1, 0, 0}}, {0x20, {1, 1, 0}}};

class BlockRules : public testing::TestWithParam<Layout> {
 protected:
  using Rule = std::uint32_t (*)(std::uint32_t);

  void load(Rule rule) { bench.load(rule); }
  // Regroups and applies the rule, time and again.
  void run(int steps) {
    for (int i = 0; i < steps; ++i) {
      bench.step(is_across ? kBack : kAcross);
      is_across = !is_across;
    }
  }
  // The rule where it is, without moving; then the blocks before.
  void undo(int steps, Rule rule) {
    for (int i = 0; i < steps; ++i) {
      bench.load(rule);
      bench.step({});
      bench.load(test::identity);
      bench.step(is_across ? kBack : kAcross);
      is_across = !is_across;
    }
  }
  Cells random_blocks(std::uint16_t mask) {
    std::mt19937 random(21);
    return test::random_cells(bench.cell_count(), mask, random);
  }
  std::uint64_t population(const Cells& cells) const {
    std::uint64_t count = 0;
    for (const std::uint16_t cell : cells) {
      count += static_cast<std::uint64_t>(std::popcount(cell & kBlock));
    }
    return count;
  }

  CamBench bench{GetParam()};
  bool is_across{false};
};
INSTANTIATE_TEST_SUITE_P(Layouts, BlockRules,
                         testing::Values(Layout{{0, 0, 0}, {3, 3, 0}, Division::Mesh},
                                         Layout{{1, 1, 0}, {3, 3, 0}, Division::Mesh},
                                         Layout{{2, 2, 0}, {3, 3, 0}, Division::Mesh}));

std::uint32_t others(std::uint32_t site) { return site & ~kBlock; }
std::uint32_t opposite(std::uint32_t block) {
  return (block & 1U) << 3 | (block & 2U) << 1 | (block & 4U) >> 1 | (block & 8U) >> 3;
}
// (0,0) to (1,0) to (1,1) to (0,1).
std::uint32_t clockwise(std::uint32_t block) {
  return (block & 1U) << 1 | (block & 2U) << 2 | (block & 8U) >> 1 | (block & 4U) >> 2;
}
std::uint32_t counter_clockwise(std::uint32_t block) {
  return clockwise(clockwise(clockwise(block)));
}
bool is_diagonal(std::uint32_t block) { return block == 0x9 || block == 0x6; }

// --- Billiard balls: a lone ball flies on, a pair on a diagonal turns to the other one.

std::uint32_t billiard(std::uint32_t site) {
  const std::uint32_t block = site & kBlock;
  if (std::popcount(block) == 1) return others(site) | opposite(block);
  return is_diagonal(block) ? site ^ kBlock : site;
}

TEST_P(BlockRules, BilliardBallsAreKeptAndRunBack) {
  const Cells start = random_blocks(kBlock);
  bench.put(start);
  load(billiard);
  run(6);
  EXPECT_NE(bench.get(), start);
  EXPECT_EQ(population(bench.get()), population(start));
  undo(6, billiard);
  EXPECT_EQ(bench.get(), start);
}

// --- Critters: the complement unless two of four are set; three are turned round besides.

std::uint32_t critters(std::uint32_t site) {
  const std::uint32_t block = site & kBlock;
  const int count = std::popcount(block);
  if (count == 2) return site;
  const std::uint32_t after = block ^ kBlock;
  return others(site) | (count == 3 ? opposite(after) : after);
}

TEST_P(BlockRules, CrittersAreAsManyAfterTwoStepsAndAsManyAsWereMissingAfterOne) {
  const Cells start = random_blocks(kBlock);
  const std::uint64_t cells = 4 * start.size();
  bench.put(start);
  load(critters);
  for (int i = 1; i <= 10; ++i) {
    run(1);
    const std::uint64_t expected = i % 2 == 0 ? population(start) : cells - population(start);
    ASSERT_EQ(population(bench.get()), expected) << i;
  }
}

// --- TM gas: blocks turn one way and the other by turns, unless two meet on a diagonal.

std::uint32_t tm_gas(std::uint32_t site) {
  const std::uint32_t block = site & kBlock;
  const bool is_odd = (site & kPhase) != 0;
  const std::uint32_t turned = is_odd ? clockwise(block) : counter_clockwise(block);
  return (is_diagonal(block) ? block : turned) | (others(site) ^ kPhase);
}
// What one step did, in place.
std::uint32_t tm_gas_back(std::uint32_t site) {
  const std::uint32_t block = site & kBlock;
  const bool was_odd = (site & kPhase) == 0;
  const std::uint32_t turned = was_odd ? counter_clockwise(block) : clockwise(block);
  return (is_diagonal(block) ? block : turned) | (others(site) ^ kPhase);
}

TEST_P(BlockRules, TheTmGasKeepsItsParticlesAndRunsBack) {
  const Cells start = random_blocks(kBlock);
  bench.put(start);
  load(tm_gas);
  run(6);
  EXPECT_NE(bench.get(), start);
  EXPECT_EQ(population(bench.get()), population(start));
  undo(6, tm_gas_back);
  EXPECT_EQ(bench.get(), start);
}

// One cell a step: so many steps around as there are cells, twice the blocks.
TEST_P(BlockRules, ALoneParticleOfTheTmGasGoesRoundTheTorus) {
  for (const unsigned layer : {0U, 1U, 2U, 3U}) {
    Cells start(bench.cell_count());
    start[bench.index_of({2, 5, 0})] = static_cast<std::uint16_t>(1U << layer);
    bench.put(start);
    load(tm_gas);
    run(8);
    EXPECT_NE(bench.get(), start) << layer;
    run(8);
    EXPECT_EQ(bench.get(), start) << layer;
  }
}

// --- Diffusion: each block turns as the random bit says that just passes.

TEST_P(BlockRules, DiffusionKeepsItsParticlesAndSpreadsThem) {
  Cells start = random_blocks(0x20);
  for (std::size_t i = 0; i < start.size() / 8; ++i) {
    start[i] = static_cast<std::uint16_t>(start[i] | kBlock);
  }
  bench.put(start);
  load([](std::uint32_t site) {
    const std::uint32_t block = site & kBlock;
    return others(site) | ((site & 0x20) != 0 ? clockwise(block) : counter_clockwise(block));
  });
  run(24);
  const Cells after = bench.get();
  EXPECT_EQ(population(after), population(start));
  const auto is_taken = [](std::uint16_t site) { return (site & kBlock) != 0; };
  EXPECT_GT(std::count_if(after.begin(), after.end(), is_taken),
            2 * std::count_if(start.begin(), start.end(), is_taken));
}

// --- FHP: six directions on a sheared lattice, layer 6 turns pairs one way or the other.

const std::vector<LayerKick> kToSix{{1, {1, 0, 0}},  {2, {0, 1, 0}},   {4, {-1, 1, 0}},
                                    {8, {-1, 0, 0}}, {16, {0, -1, 0}}, {32, {1, -1, 0}}};

std::uint32_t turn_six(std::uint32_t gas) { return ((gas << 1) | (gas >> 5)) & 0x3fU; }

std::uint32_t fhp(std::uint32_t site) {
  const std::uint32_t gas = site & 0x3fU;
  const bool is_left = (site & 0x40U) != 0;
  std::uint32_t after = gas;
  if (gas == 0x09 || gas == 0x12 || gas == 0x24) {
    after = is_left ? turn_six(gas) : turn_six(turn_six(gas));
  }
  if (gas == 0x15 || gas == 0x2a) after = gas ^ 0x3fU;
  return (site & ~0x3fU) | after;
}

TEST(HexagonalGas, KeepsParticlesAndMomentumButNotEachPairOfDirections) {
  const auto along = [](const Cells& cells) {
    std::array<std::int64_t, 6> count{};
    for (const std::uint16_t cell : cells) {
      for (std::size_t i = 0; i < 6; ++i) count[i] += (cell >> i) & 1;
    }
    return count;
  };
  const auto kept = [&](const Cells& cells) {
    const auto n = along(cells);
    return std::array<std::int64_t, 3>{n[0] + n[1] + n[2] + n[3] + n[4] + n[5],
                                       n[0] - n[2] - n[3] + n[5], n[1] + n[2] - n[4] - n[5]};
  };
  std::mt19937 random(22);
  CamBench bench({{1, 1, 0}, {5, 5, 0}, Division::Mesh});
  const Cells start = test::random_cells(bench.cell_count(), 0x7f, random);
  bench.put(start);
  bench.load(fhp);
  bench.step(kToSix, 30);
  const Cells after = bench.get();
  EXPECT_EQ(kept(after), kept(start));
  // With collisions of pairs alone this would be kept, too.
  const auto before = along(start);
  const auto now = along(after);
  EXPECT_NE(now[0] - now[3], before[0] - before[3]);
}

}  // namespace
}  // namespace thimble::cambus
