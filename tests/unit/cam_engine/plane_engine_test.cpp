#include "sim/model/cam/engine/plane_engine.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <vector>

#include "tests/support/allocation_count.hpp"
#include "tests/unit/cam_engine/plain_space.hpp"

namespace thimble::sim::cam {
namespace {

using test::Cells;
using test::PlainSpace;

// Rows of parts of words, of one word, of a vector and more; a word in all, a block, several.
constexpr std::array<std::array<int, 3>, 17> kSpaces{{{6, 0, 0},
                                                      {0, 6, 0},
                                                      {0, 0, 6},
                                                      {3, 3, 0},
                                                      {2, 2, 3},
                                                      {5, 4, 4},
                                                      {1, 12, 0},
                                                      {6, 4, 3},
                                                      {6, 2, 5},
                                                      {6, 3, 0},
                                                      {7, 6, 0},
                                                      {8, 2, 3},
                                                      {9, 4, 0},
                                                      {10, 1, 2},
                                                      {12, 1, 0},
                                                      {13, 0, 1},
                                                      {10, 0, 0}}};

PlaneKick random_kick(unsigned layer, const SiteSpace& space, std::mt19937& random) {
  PlaneKick kick{static_cast<LayerBits>(1U << layer), {}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const unsigned length = 1U << space.log2_cells[axis];
    // Small ones are frequent; others may go round several times.
    const unsigned span = random() % 2 == 0 ? 2 : 2 * length + 3;
    kick.cells[axis] = static_cast<int>(random() % (2 * span + 1)) - static_cast<int>(span);
    if (random() % 3 == 0) kick.cells[axis] = 0;
  }
  return kick;
}

StepOptions random_options(std::mt19937& random) {
  StepOptions options;
  options.bank = random() % Engine::kBanks;
  if (random() % 2 == 0) {
    options.fixed = static_cast<LayerBits>(random());
    options.fixed_bits = static_cast<LayerBits>(random());
  }
  if (random() % 2 == 0) options.written = static_cast<LayerBits>(random());
  options.counting = static_cast<Counting>(random() % 3);
  return options;
}

class PlaneEngineTest : public test::EachInstructionSet {
 protected:
  std::unique_ptr<PlaneEngine> make(const SiteSpace& space, TablePath path) {
    return PlaneEngine::make(space, path, *GetParam()).value();
  }

  void expect_same_as_plain(const SiteSpace& space, TablePath path, std::mt19937& random) {
    const auto engine = make(space, path);
    PlainSpace plain{space, test::random_cells(space.sites(), random)};
    ASSERT_TRUE(engine->put(plain.cells));
    std::array<test::Table, Engine::kBanks> tables;
    Cells cells(space.sites());
    for (int i = 0; i < 6; ++i) {
      if (i % 3 == 0) {
        for (std::size_t bank = 0; bank < tables.size(); ++bank) {
          tables[bank] = path == TablePath::General ? test::random_table(random)
                                                    : test::random_small_table(random);
          ASSERT_TRUE(engine->load(bank, tables[bank]));
        }
      }
      std::vector<PlaneKick> kicks;
      for (unsigned layer = 0; layer < 16; ++layer) {
        if (random() % 4 != 0) kicks.push_back(random_kick(layer, space, random));
      }
      const StepOptions options = random_options(random);
      const auto counts = engine->step(kicks, options);
      ASSERT_TRUE(counts);
      ASSERT_EQ(*counts, plain.step(tables[options.bank], kicks, options)) << i;
      ASSERT_TRUE(engine->get(cells));
      ASSERT_EQ(cells, plain.cells) << i;
      const std::size_t layer = random() % kPlanes;
      std::vector<Word> bits(space.sites() / kWordSites);
      ASSERT_TRUE(engine->get_layer(layer, bits));
      for (std::size_t site = 0; site < cells.size(); ++site) {
        ASSERT_EQ(bits[site / kWordSites] >> (site % kWordSites) & 1, cells[site] >> layer & 1U);
      }
      const PlaneCounts all = PlainSpace(plain).step(tables[0], {}, {.counting = Counting::Sites});
      ASSERT_EQ(engine->population(), all) << i;
    }
  }
};
INSTANTIATE_TEST_SUITE_P(Kernels, PlaneEngineTest, test::instruction_sets(), test::set_name);

TEST_P(PlaneEngineTest, LooksTablesUpAsSiteBySite) {
  std::mt19937 random(51);
  for (const auto& axes : kSpaces) {
    SCOPED_TRACE(testing::PrintToString(axes));
    expect_same_as_plain({axes}, TablePath::General, random);
  }
}

TEST_P(PlaneEngineTest, RunsCompiledTablesAsSiteBySite) {
  std::mt19937 random(52);
  for (const auto& axes : kSpaces) {
    SCOPED_TRACE(testing::PrintToString(axes));
    expect_same_as_plain({axes}, TablePath::Compiled, random);
  }
}

TEST_P(PlaneEngineTest, LayersThatKeepTheirBitsMoveWithoutBeingWritten) {
  std::mt19937 random(53);
  const SiteSpace space{{7, 4, 2}};
  PlainSpace plain{space, test::random_cells(space.sites(), random)};
  const auto engine = make(space, TablePath::Auto);
  const auto identity = test::table_of([](std::uint32_t value) { return value; });
  ASSERT_TRUE(engine->put(plain.cells));
  Cells cells(space.sites());
  for (int i = 0; i < 50; ++i) {
    const std::vector<PlaneKick> kicks{{0x00ff, {1, -3, 1}}, {0x0f00, {-1, 0, 5}}};
    ASSERT_TRUE(engine->step(kicks, {}));
    plain.step(identity, kicks, {});
  }
  ASSERT_TRUE(engine->get(cells));
  EXPECT_EQ(cells, plain.cells);
}

TEST_P(PlaneEngineTest, ATableIsCompiledWhereItCanBe) {
  std::mt19937 random(54);
  const auto engine = make({{6, 0, 0}}, TablePath::Auto);
  ASSERT_TRUE(engine->load(0, test::random_small_table(random)));
  ASSERT_TRUE(engine->load(1, test::random_table(random)));
  EXPECT_TRUE(engine->compiled_ops(0));
  EXPECT_FALSE(engine->compiled_ops(1));
  const auto general = make({{6, 0, 0}}, TablePath::General);
  ASSERT_TRUE(general->load(0, test::random_small_table(random)));
  EXPECT_FALSE(general->compiled_ops(0));
}

TEST_P(PlaneEngineTest, WhatDoesNotCompileIsRefusedAndTheTableBeforeStays) {
  std::mt19937 random(55);
  const auto engine = make({{6, 0, 0}}, TablePath::Compiled);
  ASSERT_TRUE(engine->load(0, test::table_of([](std::uint32_t value) { return ~value; })));
  const auto loaded = engine->load(0, test::random_table(random));
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().code, Errc::Unsupported);
  Cells cells(64, 0x0ff0);
  ASSERT_TRUE(engine->put(cells));
  ASSERT_TRUE(engine->step({}, {}));
  ASSERT_TRUE(engine->get(cells));
  EXPECT_EQ(cells, Cells(64, 0xf00f));
}

TEST(PlaneEngineMake, SpacesThatCannotBeAreRefused) {
  using Axes = std::array<int, 3>;
  for (const Axes& axes :
       {Axes{5, 0, 0}, Axes{0, 0, 0}, Axes{-1, 7, 0}, Axes{31, 0, 0}, Axes{11, 10, 10}}) {
    const auto made = PlaneEngine::make({axes}, TablePath::Auto);
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().code, Errc::InvalidArgument);
  }
}

TEST(PlaneEngineMake, WhatDoesNotFitIsRefusedAndChangesNothing) {
  const auto engine = PlaneEngine::make({{3, 3, 0}}, TablePath::Auto).value();
  Cells cells(64, 0x1234);
  ASSERT_TRUE(engine->put(cells));
  Cells fewer(63);
  EXPECT_FALSE(engine->put(fewer));
  EXPECT_FALSE(engine->get(fewer));
  std::vector<Word> bits(1);
  EXPECT_FALSE(engine->get_layer(kPlanes, bits));
  bits.resize(2);
  EXPECT_FALSE(engine->get_layer(0, bits));
  const test::Table table(65535);
  EXPECT_FALSE(engine->load(0, table));
  EXPECT_FALSE(engine->load(2, test::Table(65536)));
  const std::vector<PlaneKick> kicks{{0xffff, {1, 0, 0}}};
  EXPECT_FALSE(engine->step(kicks, {.bank = 2}));
  ASSERT_TRUE(engine->get(cells));
  EXPECT_EQ(cells, Cells(64, 0x1234));
}

TEST(PlaneEngineMake, ASpaceIsEmptyAtFirst) {
  const auto engine = PlaneEngine::make({{3, 3, 0}}, TablePath::Auto).value();
  EXPECT_EQ(engine->population(), PlaneCounts{});
}

// While it steps, whatever the tables and kicks.
TEST(PlaneEngineMake, TakesTwoBytesASiteAndAtMostAsMuchAgain) {
  constexpr SiteSpace kSpace{{10, 10, 0}};
  constexpr std::int64_t kHalfMiB = 1 << 19;
  const auto two_bytes_a_site = static_cast<std::int64_t>(2 * kSpace.sites());
  for (const TablePath path : {TablePath::General, TablePath::Auto}) {
    std::mt19937 random(7);
    const std::int64_t before = thimble::test::allocated_bytes();
    const auto engine = PlaneEngine::make(kSpace, path).value();
    for (std::size_t bank = 0; bank < Engine::kBanks; ++bank) {
      const auto table = path == TablePath::General ? test::random_table(random)
                                                    : test::random_small_table(random);
      ASSERT_TRUE(engine->load(bank, table));
    }
    thimble::test::begin_most_allocated_bytes();
    for (int i = 0; i < 8; ++i) {
      std::vector<PlaneKick> kicks;
      for (unsigned layer = 0; layer < 16; ++layer) {
        kicks.push_back(random_kick(layer, kSpace, random));
      }
      ASSERT_TRUE(engine->step(kicks, random_options(random)));
    }
    const std::int64_t most = thimble::test::most_allocated_bytes() - before;
    EXPECT_GE(most, two_bytes_a_site);
    // A thread's own, and two tables of 128 KiB with what is made of them.
    EXPECT_LE(most, 2 * two_bytes_a_site + 2 * kHalfMiB);
  }
}

}  // namespace
}  // namespace thimble::sim::cam
