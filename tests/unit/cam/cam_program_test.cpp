#include "drivers/cambus/cam_program.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/unit/cam/cam_bench.hpp"

namespace thimble::cambus {
namespace {

using test::CamBench;
using test::Cells;
using test::Layout;

// What a shift of the whole space makes of one layer's bits.
Cells shifted(const CamBench& bench, const Cells& cells, const std::vector<LayerKick>& kicks) {
  Cells after(cells.size(), 0);
  for (int layer = 0; layer < kLayers; ++layer) {
    Axes by{};
    for (const LayerKick& kick : kicks) {
      if (((kick.layers >> layer) & 1U) != 0) by = kick.cells;
    }
    for (std::size_t i = 0; i < cells.size(); ++i) {
      Axes to = bench.cell_at(i);
      for (std::size_t axis = 0; axis < 3; ++axis) to[axis] += by[axis];
      auto& cell = after[bench.index_of(to)];
      cell = static_cast<std::uint16_t>(cell | (cells[i] & (1U << layer)));
    }
  }
  return after;
}

class OnAnyBoard : public testing::TestWithParam<Layout> {};
INSTANTIATE_TEST_SUITE_P(Layouts, OnAnyBoard,
                         testing::Values(Layout{{0, 0, 0}, {4, 4, 1}, Division::Mesh},
                                         Layout{{1, 0, 0}, {4, 4, 0}, Division::Mesh},
                                         Layout{{1, 0, 0}, {4, 4, 0}, Division::StripY},
                                         Layout{{1, 1, 0}, {4, 4, 0}, Division::Mesh},
                                         Layout{{1, 1, 0}, {3, 4, 1}, Division::StripY},
                                         Layout{{1, 1, 1}, {3, 3, 3}, Division::Mesh},
                                         Layout{{1, 1, 1}, {4, 3, 2}, Division::StripX},
                                         Layout{{1, 1, 1}, {3, 4, 2}, Division::StripY},
                                         Layout{{1, 1, 1}, {2, 2, 4}, Division::StripZ},
                                         Layout{{2, 1, 0}, {4, 3, 0}, Division::Mesh},
                                         Layout{{2, 1, 0}, {3, 4, 0}, Division::StripY},
                                         Layout{{2, 2, 2}, {4, 4, 3}, Division::Mesh},
                                         Layout{{2, 2, 2}, {2, 7, 1}, Division::StripY}));

TEST_P(OnAnyBoard, ModulesAreNumberedAlongTheWay) {
  CamBench bench(GetParam());
  const auto& shape = GetParam().log2_modules;
  for (int n = 0; n < bench.space().modules(); ++n) {
    const Axes at = position_of(bench.space().board(), n);
    const auto index =
        static_cast<std::size_t>(at[0] | at[1] << shape[0] | at[2] << (shape[0] + shape[1]));
    int id = 0;
    for (std::size_t layer = 0; layer < kLayers; ++layer) {
      const auto& registers = bench.machine().torus().modules[index].registers;
      id |= static_cast<int>(registers.get(field::kModuleId[0], layer)) << layer;
    }
    EXPECT_EQ(id, n);
  }
}

TEST_P(OnAnyBoard, SitesComeBackAsTheyWerePut) {
  std::mt19937 random(1);
  CamBench bench(GetParam());
  const Cells cells = test::random_cells(bench.cell_count(), 0xffff, random);
  bench.put(cells);
  EXPECT_EQ(bench.get(), cells);
}

// The law of the machine: a kick shifts its layers, whatever module a bit is in, over edges and
// corners.
TEST_P(OnAnyBoard, AKickShiftsTheWholeSpace) {
  std::mt19937 random(2);
  CamBench bench(GetParam());
  bench.load(test::identity);
  Cells cells = test::random_cells(bench.cell_count(), 0xffff, random);
  bench.put(cells);
  for (int i = 0; i < 12; ++i) {
    std::vector<LayerKick> kicks;
    for (int layer = 0; layer < kLayers; ++layer) {
      LayerKick& kick = kicks.emplace_back();
      kick.layers = static_cast<LayerMask>(1U << layer);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const int most = 1 << bench.space().log2_sector()[axis];
        kick.cells[axis] = static_cast<int>(random() % static_cast<unsigned>(2 * most + 1)) - most;
      }
    }
    bench.step(kicks);
    cells = shifted(bench, cells, kicks);
    ASSERT_EQ(bench.get(), cells) << i;
  }
}

// Of any rule: how fast sites are visited, and in which bank its table lies, is nobody's business.
TEST_P(OnAnyBoard, NeitherTheScanModeNorTheBankChangesWhatComesOut) {
  std::mt19937 random(7);
  std::vector<std::uint32_t> rule(kTableEntries);
  for (auto& entry : rule) entry = random() & 0xffffU;
  const auto rule_of = [&](std::uint32_t cell) { return rule[cell]; };
  Cells first;
  Cells expected;
  for (const std::uint32_t mode : {3U, 2U, 1U, 0U}) {
    for (const int loads : {1, 2}) {
      CamBench bench(GetParam());
      if (first.empty()) first = test::random_cells(bench.cell_count(), 0xffff, random);
      bench.put(first);
      for (int i = 0; i < loads; ++i) bench.load(rule_of);
      StepListBuilder builder;
      builder.write(bench.space().scan_format(bench.space().whole()).set(field::kScanMode, mode));
      bench.play(builder.finish());
      bench.step({{layers(0, 6), {1, -1, 0}}, {layers(7, 15), {-2, 0, 0}}}, 2);
      const Cells after = bench.get();
      if (expected.empty()) expected = after;
      ASSERT_EQ(after, expected) << "mode " << mode << ", loaded " << loads << " times";
    }
  }
  EXPECT_NE(expected, first);
}

TEST_P(OnAnyBoard, CountsAreThePopulation) {
  std::mt19937 random(3);
  CamBench bench(GetParam());
  const Cells cells = test::random_cells(bench.cell_count(), 0x7fff, random);
  bench.load([](std::uint32_t cell) { return cell >> 1 | 0x8000U; });
  bench.put(cells);
  for (const auto events : {CamProgram::Events::Site, CamProgram::Events::Table}) {
    CamProgram program(bench.space());
    ASSERT_TRUE(program.kick({}));
    program.run({.is_scan = false, .takes_counts = true});
    program.count(events);
    program.run();
    program.run({.is_scan = false, .takes_counts = true});
    const auto slots = program.read_counts();
    bench.play(program);
    for (int layer = 0; layer < kLayers; ++layer) {
      std::uint32_t count = 0;
      for (const ReadSlot& slot : slots) count += count_of_layer(bench.words_of(slot), layer);
      const auto population = [&](int of) {
        return std::count_if(cells.begin(), cells.end(),
                             [&](std::uint16_t cell) { return ((cell >> of) & 1U) != 0; });
      };
      const bool is_table = events == CamProgram::Events::Table;
      const auto expected = is_table && layer == 15 ? static_cast<std::ptrdiff_t>(cells.size())
                                                    : population(is_table ? layer + 1 : layer);
      EXPECT_EQ(count, expected) << layer;
    }
    bench.put(cells);
  }
}

constexpr Layout kSmall{{0, 0, 0}, {3, 3, 0}, Division::Mesh};

TEST(CamProgramOnABoard, TheTableSeesWhatIsFixed) {
  std::mt19937 random(4);
  CamBench bench(kSmall);
  const Cells cells = test::random_cells(bench.cell_count(), 0x00ff, random);
  bench.put(cells);
  bench.load([](std::uint32_t cell) { return (cell & 0xffU) | (cell & 0xfU) << 8; });
  CamProgram program(bench.space());
  program.fix(layers(0, 3), 0x5);
  program.run();
  program.fix(0, 0);
  bench.play(program);
  const Cells after = bench.get();
  for (std::size_t i = 0; i < cells.size(); ++i) {
    EXPECT_EQ(after[i], 0x0500 | (cells[i] & 0xf0) | 0x5);
  }
}

TEST(CamProgramOnABoard, ABijectionIsUndoneByItsInverse) {
  std::mt19937 random(5);
  CamBench bench({{1, 1, 0}, {3, 3, 0}, Division::Mesh});
  std::vector<std::uint32_t> there(kTableEntries);
  std::iota(there.begin(), there.end(), 0U);
  std::shuffle(there.begin(), there.end(), random);
  std::vector<std::uint32_t> back(kTableEntries);
  for (std::uint32_t n = 0; n < there.size(); ++n) back[there[n]] = n;
  const Cells cells = test::random_cells(bench.cell_count(), 0xffff, random);
  bench.put(cells);
  const std::vector<LayerKick> kicks{{0x0f0f, {1, -2, 0}}, {0xf000, {0, 3, 0}}};
  const std::vector<LayerKick> kicks_back{{0x0f0f, {-1, 2, 0}}, {0xf000, {0, -3, 0}}};
  bench.load([&](std::uint32_t cell) { return there[cell]; });
  bench.step(kicks);
  EXPECT_NE(bench.get(), cells);
  bench.load([&](std::uint32_t cell) { return back[cell]; });
  bench.step({});
  bench.load(test::identity);
  bench.step(kicks_back);
  EXPECT_EQ(bench.get(), cells);
}

}  // namespace
}  // namespace thimble::cambus
