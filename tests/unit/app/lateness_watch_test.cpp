#include "daemon/app/lateness_watch.hpp"

#include <gtest/gtest.h>

#include <random>
#include <utility>
#include <vector>

namespace thimble::app {
namespace {

MonotonicTime at(double s) { return {from_seconds(s)}; }

TEST(LatenessWatch, KnowsNothingOfAnArmThatWasNeverLate) {
  LatenessWatch sut;
  EXPECT_EQ(sut.missed_lately(0), 0U);
  sut.note(1, at(1), 0);
  EXPECT_EQ(sut.missed_lately(1), 0U);
}

TEST(LatenessWatch, ForgetsAfterTenSeconds) {
  LatenessWatch sut;
  sut.note(0, at(1), 3);
  sut.note(0, at(11), 3);
  EXPECT_EQ(sut.missed_lately(0), 3U);
  sut.note(0, at(11.1), 3);
  EXPECT_EQ(sut.missed_lately(0), 0U);
}

TEST(LatenessWatch, BeginsAnewWhenAnotherServoCounts) {
  LatenessWatch sut;
  sut.note(0, at(1), 3);
  sut.note(0, at(2), 1);
  EXPECT_EQ(sut.missed_lately(0), 0U);
  sut.note(0, at(3), 2);
  EXPECT_EQ(sut.missed_lately(0), 1U);
}

TEST(LatenessWatch, IsWorthTellingFromAMillisecondOnWhateverTheRate) {
  for (const double rate_hz : {500, 1000, 2000, 4000, 8000}) {
    const Duration period = from_seconds(1 / rate_hz);
    EXPECT_FALSE(is_worth_telling(0, period));
    for (std::uint64_t missed = 1; missed < 20; ++missed) {
      EXPECT_EQ(is_worth_telling(missed, period), static_cast<double>(missed) * 1000 >= rate_hz)
          << missed << " at " << rate_hz;
    }
  }
}

TEST(LatenessWatch, AgreesWithAPlainListOfMisses) {
  std::mt19937 random(2);
  LatenessWatch sut;
  std::vector<std::pair<double, std::uint64_t>> misses;
  std::uint64_t total = 0;
  for (double now_s = 0; now_s < 200; now_s += 0.02) {
    if (random() % 100 == 0) {
      const std::uint64_t missed = 1 + random() % 5;
      total += missed;
      misses.emplace_back(now_s, missed);
    }
    sut.note(0, at(now_s), total);
    std::uint64_t expected = 0;
    for (const auto& [when_s, missed] : misses) {
      if (at(now_s) - at(when_s) <= LatenessWatch::kWindow) expected += missed;
    }
    ASSERT_EQ(sut.missed_lately(0), expected) << now_s;
  }
}

}  // namespace
}  // namespace thimble::app
