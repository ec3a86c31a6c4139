#include "daemon/servo/tick_histogram.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace thimble::servo {
namespace {

TEST(TickHistogram, IsZeroWhileEmpty) {
  TickHistogram sut;
  EXPECT_EQ(sut.quantiles().p50, Duration{});
  EXPECT_EQ(sut.quantiles().max, Duration{});
}

TEST(TickHistogram, QuantilesAgreeWithASortedListWithinABucket) {
  std::mt19937_64 random(9);
  std::lognormal_distribution<double> spread(8, 3);
  TickHistogram sut;
  std::vector<std::int64_t> oracle;
  for (int i = 0; i < 20'000; ++i) {
    const auto ns = static_cast<std::int64_t>(spread(random));
    sut.add(Duration(ns));
    oracle.push_back(ns);
  }
  std::sort(oracle.begin(), oracle.end());

  const TickQuantiles q = sut.quantiles();

  const auto p50 = static_cast<double>(oracle[9'999]);
  const auto p99 = static_cast<double>(oracle[19'799]);
  EXPECT_NEAR(static_cast<double>(q.p50.count()), p50, 0.07 * p50 + 1);
  EXPECT_NEAR(static_cast<double>(q.p99.count()), p99, 0.07 * p99 + 1);
  EXPECT_EQ(q.max.count(), oracle.back());
}

TEST(TickHistogram, TellsTheFewestNanosecondsApart) {
  TickHistogram sut;
  for (int ns = 1; ns <= 15; ++ns) sut.add(Duration(ns));
  EXPECT_EQ(sut.quantiles().p50, Duration(8));
  EXPECT_EQ(sut.quantiles().p99, Duration(15));
}

TEST(TickHistogram, TakesEveryDurationWithoutLeavingItsBuckets) {
  TickHistogram sut;
  for (int bit = 0; bit < 63; ++bit) sut.add(Duration(std::int64_t{1} << bit));
  sut.add(Duration::max());
  sut.add(Duration(-5));
  EXPECT_EQ(sut.quantiles().max, Duration::max());
}

}  // namespace
}  // namespace thimble::servo
