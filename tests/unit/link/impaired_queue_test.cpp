#include "daemon/link/impaired_queue.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace thimble::link {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

MonotonicTime at(Duration t) { return {t}; }

std::vector<int> drain(ImpairedQueue<int>& queue, MonotonicTime now) {
  std::vector<int> out;
  for (int value = 0; queue.pop_due(now, value);) out.push_back(value);
  return out;
}

TEST(ImpairedQueue, HandsOverInOrderAndAtOnceWithoutImpairment) {
  ImpairedQueue<int> sut({}, 0);
  for (int i = 0; i < 100; ++i) sut.push(at(milliseconds(1)), i);
  const std::vector<int> out = drain(sut, at(milliseconds(1)));
  ASSERT_EQ(out.size(), 100U);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(out[static_cast<std::size_t>(i)], i);
  EXPECT_FALSE(sut.next_due().has_value());
}

TEST(ImpairedQueue, DelaysEachDirectionByHalfTheRoundTrip) {
  ImpairedQueue<int> sut({.delay_s = 0.1}, 0);
  sut.push(at(milliseconds(7)), 1);
  ASSERT_TRUE(sut.next_due().has_value());
  EXPECT_EQ(sut.next_due()->since_epoch, milliseconds(57));
  EXPECT_TRUE(drain(sut, at(milliseconds(57) - Duration(1))).empty());
  EXPECT_EQ(drain(sut, at(milliseconds(57))), std::vector<int>{1});
}

TEST(ImpairedQueue, JitterStaysInItsBoundsAndKeepsTheOrder) {
  ImpairedQueue<int> sut({.delay_s = 0.02, .jitter_s = 0.01, .seed = 3}, 0);
  Duration shortest = milliseconds(1000);
  Duration longest{};
  for (int i = 0; i < 2000; ++i) {
    const MonotonicTime sent = at(milliseconds(100 * i));
    sut.push(sent, i);
    const Duration delay = *sut.next_due() - sent;
    shortest = std::min(shortest, delay);
    longest = std::max(longest, delay);
    EXPECT_EQ(drain(sut, *sut.next_due()), std::vector<int>{i});
  }
  EXPECT_GE(shortest, milliseconds(5));
  EXPECT_LT(shortest, microseconds(5100));
  EXPECT_LE(longest, milliseconds(15));
  EXPECT_GT(longest, microseconds(14900));

  ImpairedQueue<int> dense({.delay_s = 0.02, .jitter_s = 0.01, .seed = 3}, 0);
  int next = 0;
  for (int i = 0; i < 2000; ++i) {
    dense.push(at(microseconds(100 * i)), i);
    for (const int value : drain(dense, at(microseconds(100 * i)))) EXPECT_EQ(value, next++);
  }
  EXPECT_GT(next, 1500);
}

TEST(ImpairedQueue, JitterLargerThanTheDelayNeverActsBeforeThePush) {
  ImpairedQueue<int> sut({.delay_s = 0.001, .jitter_s = 0.01}, 0);
  for (int i = 0; i < 1000; ++i) {
    const MonotonicTime sent = at(milliseconds(100 * i));
    sut.push(sent, i);
    EXPECT_GE(*sut.next_due(), sent);
    drain(sut, sent + milliseconds(99));
  }
}

TEST(ImpairedQueue, LosesTheConfiguredShare) {
  ImpairedQueue<int> sut({.loss = 0.3, .seed = 5}, 0);
  std::size_t arrived = 0;
  for (int i = 0; i < 10000; ++i) {
    sut.push({}, i);
    arrived += drain(sut, {}).size();
  }
  EXPECT_NEAR(static_cast<double>(arrived), 7000, 200);
  EXPECT_EQ(sut.counters().lost, 10000 - arrived);

  ImpairedQueue<int> all({.loss = 1.0}, 0);
  for (int i = 0; i < 1000; ++i) all.push({}, i);
  EXPECT_FALSE(all.next_due().has_value());
}

TEST(ImpairedQueue, DuplicatesFollowTheirOriginalAtOnce) {
  ImpairedQueue<int> sut({.duplicate = 1.0}, 0);
  sut.push({}, 1);
  sut.push({}, 2);
  EXPECT_EQ(drain(sut, {}), (std::vector<int>{1, 1, 2, 2}));
  EXPECT_EQ(sut.counters().duplicated, 2U);
}

TEST(ImpairedQueue, AReorderedMessageIsOvertakenButNeverKept) {
  ImpairedQueue<int> sut({.reorder = 0.2, .seed = 9}, 0);
  std::vector<int> out;
  for (int i = 0; i < 1000; ++i) {
    sut.push(at(milliseconds(i)), i);
    for (const int value : drain(sut, at(milliseconds(i)))) out.push_back(value);
  }
  for (const int value : drain(sut, at(milliseconds(1005)))) out.push_back(value);
  ASSERT_EQ(out.size(), 1000U);
  std::uint64_t overtaken = 0;
  int newest = -1;
  for (const int value : out) {
    if (value < newest) ++overtaken;
    newest = std::max(newest, value);
  }
  EXPECT_GT(overtaken, 150U);
  EXPECT_LE(overtaken, sut.counters().reordered);
  EXPECT_FALSE(std::is_sorted(out.begin(), out.end()));
}

TEST(ImpairedQueue, TheSameSeedGivesTheSameFates) {
  const ImpairmentSettings settings{
      .delay_s = 0.02, .jitter_s = 0.02, .loss = 0.1, .duplicate = 0.1, .reorder = 0.1, .seed = 77};
  const auto run = [](const ImpairmentSettings& s, std::uint64_t direction) {
    ImpairedQueue<int> sut(s, direction);
    std::vector<int> out;
    for (int i = 0; i < 2000; ++i) {
      sut.push(at(milliseconds(i)), i);
      for (const int value : drain(sut, at(milliseconds(i)))) out.push_back(value);
    }
    return out;
  };
  EXPECT_EQ(run(settings, 0), run(settings, 0));
  EXPECT_NE(run(settings, 0), run(settings, 1));
  ImpairmentSettings other = settings;
  other.seed = 78;
  EXPECT_NE(run(settings, 0), run(other, 0));
}

TEST(ImpairedQueue, RefusesTheNewestWhenFull) {
  ImpairedQueue<int, 4> sut({.delay_s = 0.1}, 0);
  for (int i = 0; i < 6; ++i) sut.push({}, i);
  EXPECT_EQ(sut.counters().overflowed, 2U);
  std::vector<int> out;
  for (int value = 0; sut.pop_due(at(milliseconds(50)), value);) out.push_back(value);
  EXPECT_EQ(out, (std::vector<int>{0, 1, 2, 3}));
  sut.push(at(milliseconds(50)), 7);  // there is room again
  EXPECT_TRUE(sut.next_due().has_value());
}

TEST(ImpairmentSettings, RefusesWhatCannotBe) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(validate({}).has_value());
  EXPECT_TRUE(validate({.delay_s = 2.0, .jitter_s = 2.0, .loss = 1, .duplicate = 1, .reorder = 1})
                  .has_value());
  const std::vector<std::pair<ImpairmentSettings, std::string>> wrong{
      {{.delay_s = -0.1}, "delay_s"},   {{.delay_s = 2.1}, "delay_s"},
      {{.jitter_s = nan}, "jitter_s"},  {{.loss = 1.01}, "loss"},
      {{.duplicate = -1}, "duplicate"}, {{.reorder = nan}, "reorder"},
  };
  for (const auto& [settings, key] : wrong) {
    const Result<void> result = validate(settings);
    ASSERT_FALSE(result.has_value()) << key;
    EXPECT_EQ(result.error().code, Errc::InvalidArgument);
    EXPECT_NE(result.error().message.find(key), std::string::npos) << result.error().message;
  }
}

}  // namespace
}  // namespace thimble::link
