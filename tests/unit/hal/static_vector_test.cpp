#include "hal/rt/static_vector.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace thimble::rt {
namespace {

using Bounded = StaticVector<int, 4>;

TEST(StaticVector, BehavesLikeAListThatRefusesWhatDoesNotFit) {
  std::mt19937 random(9);
  Bounded sut;
  std::vector<int> oracle;
  for (int step = 0; step < 2000; ++step) {
    if (random() % 8 == 0) {
      sut.clear();
      oracle.clear();
    } else {
      const bool fits = oracle.size() < Bounded::capacity();
      ASSERT_EQ(sut.push_back(step), fits);
      if (fits) oracle.push_back(step);
    }
    ASSERT_EQ(sut.empty(), oracle.empty());
    ASSERT_EQ(std::vector<int>(sut.begin(), sut.end()), oracle);
  }
}

TEST(StaticVector, IsEqualByWhatItHoldsAndNotByWhatItHeld) {
  Bounded one;
  Bounded other;
  for (int i = 0; i < 3; ++i) one.push_back(i);
  one.clear();
  EXPECT_EQ(one, other);
  one.push_back(7);
  EXPECT_FALSE(one == other) << "longer";
  other.push_back(8);
  EXPECT_FALSE(one == other) << "another";
  other.clear();
  other.push_back(7);
  EXPECT_EQ(one, other);
}

}  // namespace
}  // namespace thimble::rt
