#include "lab/compare/ranking.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "lab/trial/random.hpp"

namespace thimble::lab {
namespace {

std::size_t index(Metric metric) { return static_cast<std::size_t>(metric); }

// Committed before `composite` was written: who changes them, changes this, and says why.
TEST(Ranking, WeighsAsTheFactsSuggest) {
  EXPECT_EQ(kWeights, (Weights{2, 3, 2, 2, 2, 1, 1, 1, 1, 1}));
}

TEST(Ranking, AScoreIsTheWeightedMean) {
  Marks marks;
  marks.metrics[index(Metric::Stiffness)] = 1;
  EXPECT_DOUBLE_EQ(score_of(marks, kWeights), 3.0 / 16);
  EXPECT_DOUBLE_EQ(score_of(marks, kEqualWeights), 1.0 / 10);
  EXPECT_DOUBLE_EQ(score_of(marks, without(Metric::Stiffness)), 0);
  EXPECT_DOUBLE_EQ(score_of(marks, without(Metric::Edge)), 3.0 / 15);
}

TEST(Ranking, AFailedGateComesBehindAnyScore) {
  Marks good_but_unstable;
  good_but_unstable.fails[0] = true;
  Marks poor;
  poor.metrics.fill(kWorst);
  const std::vector<NetworkMarks> schemes{{good_but_unstable, Marks{}}, {poor, poor}};
  const auto standings = rank(schemes, kWeights);
  EXPECT_EQ(standings[0].scheme, 1U);
  EXPECT_EQ(standings[1].failed, 1U);
}

TEST(Ranking, EqualsShareAPlaceAndTheNextOneIsBehindThemAll) {
  const auto of = [](double score, bool fails) {
    Marks marks;
    marks.metrics.fill(score);
    marks.fails[0] = fails;
    return NetworkMarks{marks};
  };
  const std::vector<NetworkMarks> schemes{of(0.5, false), of(0.1004, false), of(0.1, false),
                                          of(0.1, true), of(0.6, false)};
  const auto standings = rank(schemes, kWeights);
  EXPECT_EQ(place_of(2, standings), 1U);
  EXPECT_EQ(place_of(1, standings), 1U);
  EXPECT_EQ(place_of(0, standings), 3U);
  EXPECT_EQ(place_of(4, standings), 4U);
  EXPECT_EQ(place_of(3, standings), 5U) << "who fails a gate is no one's equal who does not";
}

TEST(Ranking, WhatIsNoNumberIsTheWorst) {
  EXPECT_EQ(bounded_mark(std::numeric_limits<double>::quiet_NaN()), kWorst);
  EXPECT_EQ(bounded_mark(std::numeric_limits<double>::infinity()), kWorst);
  EXPECT_EQ(bounded_mark(-1), 0);
  EXPECT_EQ(bounded_mark(0.25), 0.25);
}

TEST(Ranking, TheOrderOfSchemesAndNetworksDoesNotMatter) {
  Random random(3);
  for (int round = 0; round < 200; ++round) {
    std::vector<NetworkMarks> schemes(5);
    for (NetworkMarks& networks : schemes) {
      for (int network = 0; network < 4; ++network) {
        Marks marks;
        for (double& mark : marks.metrics) mark = random.uniform(0, kWorst);
        for (bool& fails : marks.fails) fails = random.uniform(0, 1) < 0.1;
        networks.push_back(marks);
      }
    }
    const auto standings = rank(schemes, kWeights);
    std::vector<NetworkMarks> turned(schemes.rbegin(), schemes.rend());
    for (NetworkMarks& networks : turned) std::reverse(networks.begin(), networks.end());
    const auto again = rank(turned, kWeights);
    for (std::size_t i = 0; i < 5; ++i) {
      ASSERT_EQ(again[i].scheme, 4 - standings[i].scheme);
      ASSERT_NEAR(again[i].score, standings[i].score, 1e-12);
      ASSERT_GE(standings[i].failed, standings[i == 0 ? 0 : i - 1].failed);
    }
  }
}

}  // namespace
}  // namespace thimble::lab
