#include "bench/comparison.hpp"

#include <gtest/gtest.h>

#include <string>

namespace thimble::bench {
namespace {

constexpr Goal kRatioGoal{Goal::Of::Ratio, 1.1};

TEST(Median, IsTheMiddleWhateverTheOrder) {
  EXPECT_EQ(median({}), 0);
  EXPECT_EQ(median({7}), 7);
  EXPECT_EQ(median({9, 1, 4}), 4);
  EXPECT_EQ(median({8, 1, 2, 4}), 3);
}

TEST(Comparison, RatioIsTheMedianOfTheSlicesOwnRatios) {
  // The machine doubled its time in the last two slices, on both sides.
  const Comparison sut = compare("x", "ns", kRatioGoal, {10, 12, 30, 22}, {10, 10, 20, 20});
  EXPECT_DOUBLE_EQ(sut.value, 17);
  EXPECT_DOUBLE_EQ(sut.reference.value_or(0), 15);
  EXPECT_DOUBLE_EQ(sut.ratio.value_or(0), 1.15);
}

TEST(Comparison, ASliceWithoutReferenceGivesNoRatio) {
  EXPECT_EQ(compare("x", "ns", kRatioGoal, {5, 5}, {0, 0}).ratio, std::nullopt);
  EXPECT_DOUBLE_EQ(compare("x", "ns", kRatioGoal, {5, 6}, {0, 3}).ratio.value_or(0), 2);
}

TEST(Comparison, AFigureMayStandAlone) {
  const Comparison sut = compare("memory", "MiB", {Goal::Of::Value, 40}, {39, 41, 40}, {});
  EXPECT_EQ(sut.value, 40);
  EXPECT_EQ(sut.reference, std::nullopt);
  EXPECT_EQ(sut.ratio, std::nullopt);
  EXPECT_TRUE(sut.is_met());
}

TEST(Comparison, AGoalIsMetUpToItsLimit) {
  EXPECT_TRUE(compare("x", "ns", kRatioGoal, {1.1}, {1}).is_met());
  EXPECT_FALSE(compare("x", "ns", kRatioGoal, {1.2}, {1}).is_met());
  EXPECT_FALSE(compare("x", "ns", kRatioGoal, {1}, {0}).is_met()) << "no ratio is no success";
  EXPECT_FALSE(compare("x", "ns", {Goal::Of::Value, 300}, {301}, {1000}).is_met());
}

TEST(Comparison, IsALineOfJsonThatKeepsEveryDigit) {
  EXPECT_EQ(to_json(compare("trip, UDP", "us", kRatioGoal, {3}, {2})),
            R"({"name": "trip, UDP", "unit": "us", "value": 3, "reference": 2, "ratio": 1.5, )"
            R"("goal": {"of": "ratio", "at_most": 1.1000000000000001}, "is_met": false})");
  EXPECT_EQ(to_json(compare("memory", "MiB", {Goal::Of::Value, 40}, {0.1}, {})),
            R"({"name": "memory", "unit": "MiB", "value": 0.10000000000000001, "reference": null, )"
            R"("ratio": null, "goal": {"of": "value", "at_most": 40}, "is_met": true})");
}

TEST(Alternate, TakesTurnsAtGoingFirst) {
  std::string order;
  alternate(
      3, [&] { order += 's'; }, [&] { order += 'r'; });
  EXPECT_EQ(order, "srrssr");
}

}  // namespace
}  // namespace thimble::bench
