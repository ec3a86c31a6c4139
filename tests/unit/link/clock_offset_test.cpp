#include "daemon/link/clock_offset.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace thimble::link {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

MonotonicTime after(Duration time) { return {std::chrono::hours(1) + time}; }

// Their clock: ours, `offset` ahead, and faster by `drift`.
struct Clocks {
  Duration offset{};
  double drift{0};
  [[nodiscard]] Duration offset_at(MonotonicTime ours) const {
    const Duration past = ours - after({});
    return offset + Duration(std::llround(drift * static_cast<double>(past.count())));
  }
  [[nodiscard]] MonotonicTime theirs(MonotonicTime ours) const { return ours + offset_at(ours); }
};

struct Ways {
  Duration there{};
  Duration back{};
};

MonotonicTime exchange(ClockOffset& sut, const Clocks& clocks, MonotonicTime sent, Ways ways) {
  const MonotonicTime arrived = sent + ways.there;
  const MonotonicTime answered = arrived + microseconds(20);
  const MonotonicTime came_back = answered + ways.back;
  sut.note({sent, clocks.theirs(arrived), clocks.theirs(answered), came_back});
  return came_back;
}

TEST(ClockOffsetTest, IsExactWhereBothWaysAreEqual) {
  for (const Duration offset : {Duration(0), Duration(-5'000'000'123), Duration(987'654'321'001)}) {
    ClockOffset sut;
    EXPECT_FALSE(sut.is_known());
    exchange(sut, {offset}, after({}), {milliseconds(10), milliseconds(10)});
    EXPECT_TRUE(sut.is_known());
    EXPECT_EQ(sut.offset(), offset);
    EXPECT_EQ(sut.way_there(), milliseconds(10));
    EXPECT_EQ(sut.way_back(), milliseconds(10));
  }
}

TEST(ClockOffsetTest, UnequalWaysAreWithinTheErrorItTells) {
  ClockOffset sut;
  exchange(sut, {Duration(0)}, after({}), {milliseconds(30), milliseconds(2)});
  EXPECT_EQ(sut.offset(), milliseconds(14));
  EXPECT_GE(sut.error(), milliseconds(14));
  EXPECT_LE(sut.error(), milliseconds(17));
}

// Jitter of either way by itself, one ten times the other's; clocks that drift apart.
TEST(ClockOffsetTest, StaysNearTheTruthUnderUnequalJitterAndDrift) {
  std::mt19937 random(11);
  for (int run = 0; run < 40; ++run) {
    const double drift = (run % 5 - 2) * 50e-6;
    const Clocks clocks{Duration(static_cast<std::int64_t>(random()) - 2'000'000'000), drift};
    const Duration base = milliseconds(random() % 100);
    std::exponential_distribution<double> jitter_s(run % 2 == 0 ? 50 : 500);
    std::exponential_distribution<double> other_jitter_s(run % 2 == 0 ? 500 : 50);
    ClockOffset sut;
    for (int i = 0; i < 20000; ++i) {
      const MonotonicTime came_back = exchange(
          sut, clocks, after(milliseconds(i)),
          {base + from_seconds(jitter_s(random)), base + from_seconds(other_jitter_s(random))});
      if (came_back < after(milliseconds(i))) continue;
      const Duration error = sut.offset() - clocks.offset_at(came_back);
      ASSERT_LE(std::abs(error.count()), sut.error().count()) << run << " " << i;
      // Once a window is full: what drift may come to in it, and what jitter never leaves out.
      if (i > 9000) {
        ASSERT_LE(std::abs(error.count()), Duration(milliseconds(1)).count()) << run;
      }
    }
    EXPECT_NEAR(thimble::seconds(sut.way_there()), thimble::seconds(base) + 1 / jitter_s.lambda(),
                0.03);
  }
}

TEST(ClockOffsetTest, ForgetsWhatIsOlderThanItsWindow) {
  ClockOffset sut;
  exchange(sut, {Duration(0)}, after({}), {milliseconds(1), milliseconds(9)});
  const Clocks clocks{Duration(0)};
  for (int i = 1; i <= 90; ++i) {
    exchange(sut, clocks, after(milliseconds(100 * i)), {milliseconds(20), milliseconds(20)});
  }
  EXPECT_EQ(sut.offset(), Duration(0));
}

TEST(ClockOffsetTest, BeginsAnewWhenAClockWasSet) {
  for (const Duration jump : {Duration(std::chrono::hours(5)), Duration(-std::chrono::hours(5))}) {
    ClockOffset sut;
    const Ways ways{milliseconds(5), milliseconds(5)};
    exchange(sut, {Duration(0)}, after({}), ways);
    exchange(sut, {jump}, after(milliseconds(10)), ways);
    EXPECT_EQ(sut.offset(), jump);
    EXPECT_LT(sut.error(), milliseconds(7));
  }
}

TEST(ClockOffsetTest, BelievesNoExchangeThatCannotHaveBeen) {
  ClockOffset sut;
  sut.note({after(milliseconds(10)), after({}), after({}), after({})});
  EXPECT_FALSE(sut.is_known());
  sut.note({after({}), after(milliseconds(10)), after({}), after(milliseconds(10))});
  EXPECT_FALSE(sut.is_known());
  sut.note({after({}), after({}), after(milliseconds(50)), after(milliseconds(10))});
  EXPECT_FALSE(sut.is_known());
}

// Whatever times a peer makes up, within what the codec lets through.
TEST(ClockOffsetTest, NeverOverflows) {
  std::mt19937_64 random(3);
  ClockOffset sut;
  constexpr Duration kFarthest{std::int64_t{1} << 61U};  // between any two of those times
  for (int i = 0; i < 100000; ++i) {
    const auto any = [&] {
      return MonotonicTime{Duration(static_cast<std::int64_t>(random() >> 3U))};
    };
    sut.note({any(), any(), any(), any()});
    ASSERT_LE(sut.offset(), kFarthest);
    ASSERT_GE(sut.offset(), -kFarthest);
    ASSERT_GE(sut.error(), Duration(0));
    ASSERT_GE(sut.way_there(), Duration(0));
    ASSERT_GE(sut.way_back(), Duration(0));
  }
}

}  // namespace
}  // namespace thimble::link
