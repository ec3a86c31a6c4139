#include "daemon/safety/estop_latch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>

namespace thimble::safety {
namespace {

TEST(EstopLatch, IsStoppedFromTheStartHoweverHealthyAllIs) {
  EstopLatch sut;
  EXPECT_TRUE(sut.is_stopped());
  sut.judge(true);
  EXPECT_TRUE(sut.is_stopped());
}

TEST(EstopLatch, ARequestWhileAllIsHealthyFreesIt) {
  EstopLatch sut;
  sut.judge(true);
  EXPECT_TRUE(sut.reset());
  EXPECT_FALSE(sut.is_stopped());
}

TEST(EstopLatch, ARequestBeforeTheFirstLookIsSpent) {
  EstopLatch sut;
  EXPECT_FALSE(sut.reset());
  sut.judge(true);
  EXPECT_TRUE(sut.is_stopped());
}

TEST(EstopLatch, ReleaseDoesNotResumeAndAnEarlyRequestIsSpent) {
  EstopLatch sut;
  sut.judge(true);
  sut.reset();
  sut.judge(false);
  EXPECT_TRUE(sut.is_stopped());
  EXPECT_FALSE(sut.reset()) << "still pressed";
  sut.judge(true);
  EXPECT_TRUE(sut.is_stopped()) << "the release is no request, and the request is spent";
  EXPECT_TRUE(sut.reset());
}

// Of a history of h (healthy), b (bad) and r (a request): looks back instead of keeping a state.
bool is_free_after(const std::string& history) {
  const std::size_t bad = history.find_last_of('b');
  const std::string since = bad == std::string::npos ? history : history.substr(bad + 1);
  const std::size_t healthy = since.find('h');
  return healthy != std::string::npos && since.find('r', healthy) != std::string::npos;
}

TEST(EstopLatch, IsFreeExactlyWhileNothingBadCameSinceAGoodRequest) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    std::mt19937 dice(seed);
    EstopLatch sut;
    std::string history;
    for (int step = 0; step < 200; ++step) {
      const auto roll = dice() % 8;
      history += roll == 0 ? 'b' : roll < 3 ? 'r' : 'h';
      if (history.back() == 'r') {
        sut.reset();
      } else {
        sut.judge(history.back() == 'h');
      }
      ASSERT_EQ(sut.is_stopped(), !is_free_after(history)) << history;
    }
  }
}

}  // namespace
}  // namespace thimble::safety
