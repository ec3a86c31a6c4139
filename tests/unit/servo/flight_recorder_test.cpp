#include "daemon/servo/flight_recorder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <random>
#include <sstream>
#include <string>

#include "daemon/servo/flight_file.hpp"

namespace thimble::servo {
namespace {

ServoFrame numbered(std::uint64_t tick) {
  ServoFrame frame;
  frame.tick = tick;
  frame.force = {1, 2, 3};
  return frame;
}

Fault numbered_cause(std::uint64_t tick) { return {FaultCode::Estop, {}, tick, 1}; }

TEST(FlightRecorder, KeepsTheLastFramesOldestFirst) {
  FlightRecorder sut(5);
  for (std::uint64_t i = 1; i <= 11; ++i) sut.record(numbered(i));
  sut.freeze(numbered(12), numbered_cause(12));

  const FlightStop stop = sut.take();

  EXPECT_EQ(stop.cause.tick, 12U);
  ASSERT_EQ(stop.frames.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(stop.frames[i].tick, 8 + i);
}

TEST(FlightRecorder, GivesNothingUntilFrozenAndStartsAnewAfterAStop) {
  FlightRecorder sut(5);
  sut.record(numbered(1));
  EXPECT_TRUE(sut.take().frames.empty());
  sut.freeze(numbered(2), numbered_cause(2));
  sut.record(numbered(3));
  EXPECT_EQ(sut.take().frames.size(), 2U) << "what comes after the stop is no part of it";
  EXPECT_FALSE(sut.is_frozen());
  sut.freeze(numbered(4), numbered_cause(4));
  EXPECT_EQ(sut.take().frames.front().tick, 3U) << "it belongs to the next";
}

TEST(FlightRecorder, RefusesToBeBuiltWithoutRoomForAFrame) {
  EXPECT_DEATH(FlightRecorder sut(0), "broken invariant: frames > 0");
}

TEST(FlightRecorder, CountsTheStopsThatFoundNoRoom) {
  FlightRecorder sut(5);
  for (std::uint64_t i = 1; i <= 4; ++i) sut.freeze(numbered(i), numbered_cause(i));
  const FlightStop first = sut.take();
  EXPECT_EQ(first.cause.tick, 1U);
  EXPECT_EQ(first.without_room, 2U);
  const FlightStop second = sut.take();
  EXPECT_EQ(second.cause.tick, 2U);
  EXPECT_EQ(second.without_room, 0U);
  EXPECT_FALSE(sut.is_frozen());
  EXPECT_TRUE(sut.take().frames.empty());
}

// Against an oracle that keeps everything in lists.
TEST(FlightRecorder, AnyOrderOfStopsAndTakesLosesNoCauseUncounted) {
  std::mt19937 random(3);
  FlightRecorder sut(7);
  std::uint64_t tick = 0, stops = 0, taken = 0, without_room = 0, last_taken_tick = 0;
  for (int round = 0; round < 20'000; ++round) {
    const auto choice = random() % 10;
    if (choice < 7) sut.record(numbered(++tick));
    if (choice == 7) {
      ++tick;
      sut.freeze(numbered(tick), numbered_cause(tick));
      ++stops;
    }
    if (choice < 8 || !sut.is_frozen()) continue;
    const FlightStop stop = sut.take();
    ++taken;
    without_room += stop.without_room;
    ASSERT_GT(stop.cause.tick, last_taken_tick);
    last_taken_tick = stop.cause.tick;
    ASSERT_FALSE(stop.frames.empty());
    ASSERT_LE(stop.frames.size(), 7U);
    ASSERT_EQ(stop.frames.back().tick, stop.cause.tick);
    for (std::size_t i = 1; i < stop.frames.size(); ++i) {
      ASSERT_EQ(stop.frames[i].tick, stop.frames[i - 1].tick + 1) << "no hole";
    }
  }
  while (sut.is_frozen()) {
    without_room += sut.take().without_room;
    ++taken;
  }
  EXPECT_EQ(taken + without_room, stops);
  EXPECT_GT(without_room, 0U);
}

TEST(FlightFile, NamesTheCauseAndHasARowPerTickWithAsManyFieldsAsTheHeader) {
  const FlightHeader header{"right", "sim:phantom-vintage", {FaultCode::Overspeed, {}, 7, 1}, 2};
  std::istringstream text(format_flight(header, {numbered(6), numbered(7)}));
  std::string line;
  std::string columns;
  std::size_t rows = 0;
  bool has_cause = false;
  bool has_count = false;
  while (std::getline(text, line)) {
    if (line.rfind("# cause: overspeed at tick 7", 0) == 0) has_cause = true;
    if (line == "# later stops that came too fast to be recorded: 2") has_count = true;
    if (line[0] == '#') continue;
    if (columns.empty()) {
      columns = line;
      continue;
    }
    ++rows;
    EXPECT_EQ(std::count(line.begin(), line.end(), ','),
              std::count(columns.begin(), columns.end(), ','));
  }
  EXPECT_TRUE(has_cause);
  EXPECT_TRUE(has_count);
  EXPECT_EQ(rows, 2U);
}

TEST(FlightFile, ARowOfTheLongestNumbersIsWhole) {
  constexpr double kLowest = std::numeric_limits<double>::lowest();
  ServoFrame frame;
  frame.tick = std::numeric_limits<std::uint64_t>::max();
  frame.now = MonotonicTime{Duration::min()};
  frame.lateness = frame.sample_age = Duration::min();
  frame.tip = {kLowest, kLowest, kLowest};
  frame.velocity = {kLowest, kLowest, kLowest};
  frame.offset = {kLowest, kLowest, kLowest};
  frame.wish = frame.force = {kLowest, kLowest, kLowest};
  frame.gain = frame.generated_energy_j = frame.wished_energy_j = kLowest;
  frame.buttons = frame.contacts = std::numeric_limits<std::uint32_t>::max();
  frame.is_fading = true;

  const std::string text = format_flight({"right", "sim:phantom-vintage", {}, 0}, {frame});

  const std::string row = text.substr(text.rfind('\n', text.size() - 2) + 1);
  EXPECT_EQ(std::count(row.begin(), row.end(), ','), 33);
  EXPECT_EQ(row.substr(row.size() - 11), ",0,0,0,0,1\n");
}

TEST(FlightFile, EachFlagIsAColumnOfItsOwn) {
  constexpr std::array kFlags{&ServoFrame::is_in_contact, &ServoFrame::is_limited,
                              &ServoFrame::is_stale, &ServoFrame::is_frozen,
                              &ServoFrame::is_fading};
  const std::array<std::string, 5> expected{"1,0,0,0,0", "0,1,0,0,0", "0,0,1,0,0", "0,0,0,1,0",
                                            "0,0,0,0,1"};
  for (std::size_t i = 0; i < kFlags.size(); ++i) {
    ServoFrame frame;
    frame.is_stale = false;
    frame.*kFlags[i] = true;
    const std::string text = format_flight({"right", "sim:phantom-vintage", {}, 0}, {frame});
    ASSERT_GE(text.size(), 10U);
    EXPECT_EQ(text.substr(text.size() - 10), expected[i] + "\n") << i;
  }
}

}  // namespace
}  // namespace thimble::servo
