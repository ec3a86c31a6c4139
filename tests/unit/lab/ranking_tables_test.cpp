#include "lab/compare/ranking_tables.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace thimble::lab {
namespace {

const std::vector<std::string> kNames{"late", "soft", "unstable"};

NetworkMarks with(Metric metric, double mark, bool fails = false) {
  Marks marks;
  marks.metrics[static_cast<std::size_t>(metric)] = mark;
  marks.fails[static_cast<std::size_t>(Gate::Smooth)] = fails;
  return {marks, Marks{}};
}

// Onset weighs 2, stiffness 3: "late" is first, unless stiffness is left out.
std::vector<DelayMarks> sample() {
  return {
      {0.001, {with(Metric::Onset, 1), with(Metric::Stiffness, 1), with(Metric::Edge, 0, true)}},
      {0.500, {with(Metric::Onset, 2), with(Metric::Stiffness, 1), with(Metric::Edge, 0)}}};
}

TEST(RankingTables, EachMetricLeftOutHasThePlaceOfEachSchemeAtEachDelay) {
  const Table table = left_out_table(kNames, sample());
  ASSERT_EQ(table.columns.size(), 3 + kMetrics);
  EXPECT_EQ(table.columns[3].name, "onset");
  EXPECT_EQ(table.columns[4].name, "stiffness");
  EXPECT_EQ(table.columns[12].name, "traffic");
  using Row = std::vector<Cell>;
  const std::vector<Row> expected{
      {1.0, "late", 1.0, 1.0, 2.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0},
      {1.0, "soft", 2.0, 2.0, 1.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0},
      {1.0, "unstable", 3.0, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0},
      {500.0, "unstable", 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0},
      {500.0, "soft", 2.0, 3.0, 1.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0},
      {500.0, "late", 3.0, 1.0, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0}};
  EXPECT_EQ(table.rows, expected) << "who is as good as another shares its place";
  EXPECT_EQ(left_out_table(kNames, sample()).rows, table.rows);
}

TEST(RankingTables, ThePlacesHaveBesideThemEqualWeightsAndTheirRangeWithOneMetricLeftOut) {
  const Table table = ranking_table(kNames, sample());
  using Row = std::vector<Cell>;
  const std::vector<Row> expected{{1.0, 1.0, "late", 1.0 / 16, 0.0, 1.0, 1.0, 2.0, "-"},
                                  {1.0, 2.0, "soft", 1.5 / 16, 0.0, 1.0, 1.0, 2.0, "-"},
                                  {1.0, 3.0, "unstable", 0.0, 1.0, 3.0, 3.0, 3.0, "smooth:1"},
                                  {500.0, 1.0, "unstable", 0.0, 0.0, 1.0, 1.0, 1.0, "-"},
                                  {500.0, 2.0, "soft", 1.5 / 16, 0.0, 2.0, 1.0, 3.0, "-"},
                                  {500.0, 3.0, "late", 2.0 / 16, 0.0, 3.0, 1.0, 3.0, "-"}};
  EXPECT_EQ(table.rows, expected);
}

TEST(RankingTables, AnotherReadingHasAColumnWithThePlaceByIt) {
  std::vector<DelayMarks> delays = sample();
  for (DelayMarks& at : delays) {
    at.beside = {{with(Metric::Onset, 3), with(Metric::Onset, 2, true), with(Metric::Onset, 1)}};
  }
  const std::vector<std::string> readings{"by_letter"};
  const Table table = ranking_table(kNames, delays, readings);
  EXPECT_EQ(table.columns.back().name, "by_letter");
  const std::vector<double> expected{2, 3, 1, 1, 3, 2};  // late, soft, unstable; then as ranked
  ASSERT_EQ(table.rows.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    ASSERT_EQ(table.rows[i].size(), table.columns.size());
    EXPECT_EQ(table.rows[i].back(), Cell(expected[i])) << i;
  }
}

}  // namespace
}  // namespace thimble::lab
