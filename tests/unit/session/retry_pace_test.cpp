#include "daemon/session/retry_pace.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace thimble::session {
namespace {

using std::chrono::milliseconds;

struct RetryPaceTest : testing::Test {
  RetryPace sut;
  MonotonicTime now{std::chrono::seconds(5)};

  // When it tries within so long, in milliseconds from now.
  std::vector<long> tries_within(int duration_ms) {
    std::vector<long> tries_ms;
    for (int ms = 0; ms < duration_ms; ++ms, now = now + milliseconds(1)) {
      if (!sut.is_due(now)) continue;
      sut.tried(now);
      tries_ms.push_back(ms);
    }
    return tries_ms;
  }
};

TEST_F(RetryPaceTest, TriesAtOnceThenLessAndLessOftenAndNeverStops) {
  EXPECT_EQ(tries_within(10'000),
            (std::vector<long>{0, 50, 150, 350, 750, 1550, 3150, 5150, 7150, 9150}));
}

TEST_F(RetryPaceTest, AReasonToTryIsANewBeginning) {
  tries_within(4000);
  sut.restart();
  EXPECT_FALSE(sut.next().has_value());
  EXPECT_EQ(tries_within(400), (std::vector<long>{0, 50, 150, 350}));
}

// What begins well and ends at once must not be begun without a rest.
TEST_F(RetryPaceTest, WhatWentWellIsNotTriedSoonerThanWasSaid) {
  tries_within(3200);  // the next at 5150
  sut.ease();
  EXPECT_EQ(*sut.next(), now + milliseconds(1950));
  EXPECT_EQ(tries_within(2300), (std::vector<long>{1950, 2000, 2100}));
}

}  // namespace
}  // namespace thimble::session
