#include "daemon/safety/line_reader.hpp"

#include <gtest/gtest.h>

#include <deque>
#include <optional>
#include <utility>

namespace thimble::safety {
namespace {

using std::chrono::milliseconds;

// Says what a test puts into its mouth.
struct ScriptedLines final : bus::GpioLines {
  std::deque<bus::GpioEdge> edges;
  std::optional<bus::GpioLevels> answer;
  bool has_overflown{false};
  bool is_gone{false};

  IoStatus next_edge(bus::GpioEdge& out) noexcept override {
    if (is_gone) return IoStatus::Disconnected;
    if (std::exchange(has_overflown, false)) return IoStatus::ProtocolError;
    if (edges.empty()) return IoStatus::NoData;
    out = edges.front();
    edges.pop_front();
    return IoStatus::Ok;
  }
  IoStatus levels(bus::GpioLevels& out) noexcept override {
    if (is_gone) return IoStatus::Disconnected;
    if (!answer) return IoStatus::NoData;
    out = *answer;
    return IoStatus::Ok;
  }
  IoStatus set(std::size_t, bool) noexcept override { return IoStatus::Ok; }
};

struct LineReaderTest : testing::Test {
  ScriptedLines lines;
  LineReader sut{2};
  MonotonicTime now{milliseconds(1000)};

  ChainTrouble step(std::uint32_t high) {
    now = now + milliseconds(5);
    lines.answer = bus::GpioLevels{high, now};
    return sut.step(lines, now);
  }
  void edge(std::uint8_t input, bool is_high, std::uint64_t sequence) {
    lines.edges.push_back({input, is_high, now, sequence});
  }
};

TEST_F(LineReaderTest, KnowsNothingBeforeTheFirstReading) {
  EXPECT_EQ(sut.step(lines, now), ChainTrouble::Silent);
  EXPECT_FALSE(sut.was_always(0, true));
  EXPECT_FALSE(sut.was_always(0, false));
}

TEST_F(LineReaderTest, TheFirstReadingCounts) {
  EXPECT_EQ(step(0b01), ChainTrouble::None);
  EXPECT_TRUE(sut.was_always(0, true));
  EXPECT_TRUE(sut.was_always(1, false));
}

TEST_F(LineReaderTest, APulseBetweenTwoLooksIsSeen) {
  step(0b11);
  edge(1, false, 1);
  edge(1, true, 2);
  EXPECT_EQ(step(0b11), ChainTrouble::None);
  EXPECT_FALSE(sut.was_always(1, true));
  EXPECT_FALSE(sut.was_always(1, false));
  EXPECT_TRUE(sut.was_always(0, true)) << "the other one is not concerned";
  EXPECT_EQ(step(0b11), ChainTrouble::None);
  EXPECT_TRUE(sut.was_always(1, true));
}

TEST_F(LineReaderTest, ALevelCountsBeforeItsEdgeAndAnEdgeBeforeItsLevel) {
  step(0b11);
  step(0b10);  // the chip says it, its kernel driver has not looked yet
  EXPECT_FALSE(sut.was_always(0, true));
  edge(0, false, 1);
  step(0b10);
  EXPECT_FALSE(sut.was_always(0, true));
  edge(1, false, 1);  // told, and the reading is still an old one
  EXPECT_EQ(step(0b10), ChainTrouble::None);
  EXPECT_FALSE(sut.was_always(1, true));
}

TEST_F(LineReaderTest, BothTellingsMustSayClosedBeforeItIs) {
  step(0b00);
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(step(0b01), ChainTrouble::None) << i;
    EXPECT_FALSE(sut.was_always(0, true)) << "its edge has not come";
  }
  edge(0, true, 1);
  step(0b01);
  EXPECT_FALSE(sut.was_always(0, true)) << "it came within this step";
  step(0b01);
  EXPECT_TRUE(sut.was_always(0, true));
}

TEST_F(LineReaderTest, AHoleInTheNumbersIsToldOnce) {
  step(0b11);
  edge(0, false, 1);
  EXPECT_EQ(step(0b10), ChainTrouble::None);
  edge(0, false, 3);
  EXPECT_EQ(step(0b10), ChainTrouble::EdgesLost);
  EXPECT_EQ(step(0b10), ChainTrouble::None);
  edge(0, true, 4);
  EXPECT_EQ(step(0b11), ChainTrouble::None);
}

TEST_F(LineReaderTest, NumbersThatRepeatOrFallAreNoBetter) {
  step(0b11);
  edge(0, false, 1);
  step(0b10);
  edge(0, true, 1);
  EXPECT_EQ(step(0b11), ChainTrouble::EdgesLost);
  edge(0, false, 0);
  EXPECT_EQ(step(0b10), ChainTrouble::EdgesLost);
}

TEST_F(LineReaderTest, MailboxesThatWereTooSmallAreAHole) {
  step(0b11);
  lines.has_overflown = true;
  EXPECT_EQ(step(0b11), ChainTrouble::EdgesLost);
  EXPECT_EQ(step(0b11), ChainTrouble::None);
}

TEST_F(LineReaderTest, ALevelThatNoEdgeEverToldIsAHoleAfterAWhile) {
  step(0b11);
  int steps = 0;
  while (step(0b01) == ChainTrouble::None && steps < 100) ++steps;
  EXPECT_EQ(steps, 31) << "150 ms, and 5 to see it";
  EXPECT_EQ(step(0b01), ChainTrouble::None) << "told; from here on the level is believed";
  EXPECT_TRUE(sut.was_always(1, false));
}

TEST_F(LineReaderTest, AnAnswerThatGrowsOldIsSilence) {
  step(0b11);
  now = now + milliseconds(200);
  EXPECT_EQ(sut.step(lines, now), ChainTrouble::None);
  now = now + milliseconds(1);
  EXPECT_EQ(sut.step(lines, now), ChainTrouble::Silent);
}

TEST_F(LineReaderTest, LinesThatAreGoneAreGone) {
  step(0b11);
  lines.is_gone = true;
  EXPECT_EQ(step(0b11), ChainTrouble::NoLines);
}

TEST_F(LineReaderTest, ALineThatChattersIsReadInSlices) {
  step(0b11);
  for (std::uint64_t i = 1; i <= 10'000; ++i) edge(0, i % 2 == 0, i);
  step(0b11);
  EXPECT_EQ(lines.edges.size(), 10'000U - 512U);
}

TEST_F(LineReaderTest, AnInputThatWasNotClaimedIsNobodys) {
  step(0b11);
  edge(7, false, 9);
  EXPECT_EQ(step(0b11), ChainTrouble::None);
}

}  // namespace
}  // namespace thimble::safety
