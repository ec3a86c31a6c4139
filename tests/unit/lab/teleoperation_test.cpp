#include "lab/teleoperation/teleoperation.hpp"

#include <gtest/gtest.h>

#include <string>
#include <variant>

namespace thimble::lab {
namespace {

const Findings& teleoperation() {
  static const Findings kFound = run_teleoperation({}).value();
  return kFound;
}

// A mark at one delay, not what was measured.
bool is_of_thesis(const Series& series) { return series.label.starts_with("thesis: "); }

TEST(Teleoperation, MeetsWhatItAsks) {
  for (const Criterion& criterion : teleoperation().criteria) {
    EXPECT_TRUE(criterion.is_met) << criterion.text;
  }
  EXPECT_EQ(teleoperation().criteria.size(), 5U);
}

TEST(Teleoperation, ComparesEachPairAtEachDelayOnEachNetwork) {
  const Table& table = teleoperation().tables.at(0);
  EXPECT_EQ(table.rows.size(), 3U * 8U * 3U);
  for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.columns.size());
  for (const Plot& plot : teleoperation().plots) {
    EXPECT_EQ(plot.series.size(), 3U + 2U) << "and what the thesis says of 50 and of 200 ms";
    for (const Series& series : plot.series) {
      EXPECT_EQ(series.points.size(), is_of_thesis(series) ? 2U : 8U) << series.label;
    }
  }
}

// teleop.md 2(b), 2(c): delay softens what a spring and damper, or waves, let one feel; thesis 3.7
// does not.
TEST(Teleoperation, OnlyTheGhostPointKeepsItsStiffnessWithDelay) {
  const Plot& stiffness = teleoperation().plots.at(0);
  for (const Series& series : stiffness.series) {
    if (is_of_thesis(series)) continue;
    const double at_1_ms = series.points.front().second;
    const double at_500_ms = series.points.back().second;
    if (series.label.starts_with("ghost-point")) {
      EXPECT_NEAR(at_500_ms, at_1_ms, 0.1 * at_1_ms);
      EXPECT_GT(at_500_ms, 600);
    } else {
      EXPECT_LT(at_500_ms, 0.2 * at_1_ms) << series.label;
    }
  }
}

TEST(Teleoperation, TheSameSeedGivesTheSameFigures) {
  EXPECT_EQ(tell(run_teleoperation({}).value()), tell(teleoperation()));
}

}  // namespace
}  // namespace thimble::lab
