#include "hal/rt/spsc_ring.hpp"

#include <gtest/gtest.h>

#include <deque>
#include <random>
#include <thread>

namespace thimble::rt {
namespace {

TEST(SpscRing, BehavesLikeABoundedQueueThatRefusesTheNewest) {
  std::mt19937 random(3);
  SpscRing<int, 8> sut;
  std::deque<int> oracle;
  std::uint64_t refused = 0;
  for (int step = 0; step < 20000; ++step) {
    if (random() % 3 != 0) {
      const bool fits = oracle.size() < 8;
      ASSERT_EQ(sut.push(step), fits);
      if (fits) oracle.push_back(step);
      if (!fits) ++refused;
      continue;
    }
    const std::size_t nth = random() % 9;
    const int* const looked_at = sut.peek(nth);
    ASSERT_EQ(looked_at != nullptr, nth < oracle.size());
    if (looked_at != nullptr) {
      ASSERT_EQ(*looked_at, oracle[nth]);
    }
    int out = -1;
    ASSERT_EQ(sut.pop(out), !oracle.empty());
    if (oracle.empty()) continue;
    ASSERT_EQ(out, oracle.front());
    oracle.pop_front();
  }
  EXPECT_EQ(sut.refused(), refused);
  EXPECT_GT(refused, 0U);
}

TEST(SpscRing, AConcurrentReaderGetsEveryAcceptedEventInOrder) {
  SpscRing<std::uint64_t, 64> sut;
  constexpr std::uint64_t kEvents = 20000;
  std::thread writer([&] {
    for (std::uint64_t i = 0; i < kEvents;) {
      if (sut.push(i)) {
        ++i;
      } else {
        std::this_thread::yield();
      }
    }
  });

  for (std::uint64_t expected = 0; expected < kEvents;) {
    std::uint64_t out = 0;
    if (!sut.pop(out)) {
      std::this_thread::yield();
      continue;
    }
    ASSERT_EQ(out, expected);
    ++expected;
  }
  writer.join();
}

}  // namespace
}  // namespace thimble::rt
