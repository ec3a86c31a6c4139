#include "sim/model/cam/engine/plane_rule.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <random>

#include "tests/unit/cam_engine/plain_space.hpp"

namespace thimble::sim::cam {
namespace {

class PlaneRuleTest : public test::EachInstructionSet {
 protected:
  void expect_compiles(const test::Table& table, std::size_t most_ops) {
    const auto rule = compile_rule(table);
    ASSERT_TRUE(rule);
    EXPECT_LE(rule->ops.size(), most_ops);
    EXPECT_TRUE(does_as_table(*rule, table, *GetParam()));
  }
};
INSTANTIATE_TEST_SUITE_P(Kernels, PlaneRuleTest, test::instruction_sets(), test::set_name);

TEST_P(PlaneRuleTest, RandomTablesOfFewInputsCompile) {
  std::mt19937 random(41);
  for (int i = 0; i < 40; ++i) expect_compiles(test::random_small_table(random), kMostPlaneOps);
}

// Symmetric functions of all sixteen layers: each level of the diagram has many nodes, all shared.
TEST_P(PlaneRuleTest, SumsCompile) {
  for (int sum = 0; sum <= 16; ++sum) {
    expect_compiles(test::table_of([&](std::uint32_t value) {
                      return std::popcount(value) >= sum ? 0x8001U : 0U;
                    }),
                    kMostPlaneOps);
  }
}

// A complement costs nothing: one operation a layer, and a load and a store.
TEST_P(PlaneRuleTest, ParityIsAChain) {
  expect_compiles(test::table_of([](std::uint32_t value) {
                    return (value & ~1U) | (static_cast<std::uint32_t>(std::popcount(value)) & 1U);
                  }),
                  17);
}

TEST_P(PlaneRuleTest, ConstantsCopiesAndComplementsCompile) {
  expect_compiles(test::table_of([](std::uint32_t) { return 0xff00U; }), 4);
  expect_compiles(test::table_of([](std::uint32_t value) { return value << 8 | value >> 8; }), 32);
  expect_compiles(test::table_of([](std::uint32_t value) { return ~value; }), 32);
}

TEST_P(PlaneRuleTest, ARuleThatDoesSomethingElseIsSeen) {
  const test::Table table = test::table_of([](std::uint32_t value) { return value ^ 1U; });
  auto rule = compile_rule(table);
  ASSERT_TRUE(rule);
  ASSERT_TRUE(does_as_table(*rule, table, *GetParam()));
  for (const std::size_t entry : {std::size_t{0}, std::size_t{12345}, std::size_t{65535}}) {
    test::Table other = table;
    other[entry] = static_cast<std::uint16_t>(other[entry] ^ 1U);
    EXPECT_FALSE(does_as_table(*rule, other, *GetParam())) << entry;
  }
  rule->ops.front().a = 2;
  EXPECT_FALSE(does_as_table(*rule, table, *GetParam()));
}

TEST(PlaneRuleShape, KeptLayersAndInputsAreSeen) {
  const TableShape shape =
      shape_of(test::table_of([](std::uint32_t value) { return value ^ (value >> 9 & 1U); }));
  EXPECT_EQ(shape.kept, 0xfffe);
  EXPECT_EQ(shape.inputs, 0x0201);
}

TEST(PlaneRuleShape, ATableThatKeepsEverythingHasNoOperations) {
  const auto rule = compile_rule(test::table_of([](std::uint32_t value) { return value; }));
  ASSERT_TRUE(rule);
  EXPECT_TRUE(rule->ops.empty());
}

TEST(PlaneRuleShape, ATableWithoutStructureIsRefused) {
  std::mt19937 random(42);
  EXPECT_FALSE(compile_rule(test::random_table(random)));
}

TEST(PlaneRuleShape, NoRuleHasMoreOperationsThanItMay) {
  std::mt19937 random(43);
  for (int i = 0; i < 20; ++i) {
    const auto table = test::random_small_table(random);
    const auto rule = compile_rule(table);
    ASSERT_TRUE(rule);
    EXPECT_TRUE(compile_rule(table, rule->ops.size()));
    EXPECT_FALSE(compile_rule(table, rule->ops.size() - 1));
  }
}

TEST(PlaneRuleShape, LayersOfTheSameFunctionAreWorkedOutOnce) {
  const auto rule = compile_rule(test::table_of([](std::uint32_t value) {
    return (value & 0x8000U) | (std::popcount(value & 0x1ffU) == 3 ? 0x1ffU : 0U);
  }));
  ASSERT_TRUE(rule);
  for (std::size_t layer = 0; layer < 9; ++layer) EXPECT_EQ(rule->same_as[layer], 0);
  EXPECT_EQ(rule->same_as[9], 9);
  EXPECT_EQ(rule->same_as[10], 9);
  EXPECT_EQ(rule->same_as[15], 15);
}

}  // namespace
}  // namespace thimble::sim::cam
