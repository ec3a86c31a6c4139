#include "daemon/app/recording_book.hpp"

#include <gtest/gtest.h>

#include <deque>
#include <random>

namespace thimble::app {
namespace {

Fault estop(std::uint32_t number) { return {FaultCode::Estop, {}, 100 * number, number}; }

TEST(RecordingBook, ShowsNoStopTheRecordingOfAnEarlierOneOfTheSameCode) {
  RecordingBook sut;
  sut.note("right", estop(1), "/flights/1");  // late: the second stop is latched by now
  EXPECT_EQ(sut.find("right", estop(2)), "");
  EXPECT_EQ(sut.find("right", estop(1)), "/flights/1");
  EXPECT_EQ(sut.find("left", estop(1)), "");
  sut.note("right", estop(2), "/flights/2");
  EXPECT_EQ(sut.find("right", estop(2)), "/flights/2");
}

TEST(RecordingBook, TellsStopsWithoutANumberApart) {
  const Fault first{FaultCode::Disconnected, {}, 5, 0};
  const Fault second{FaultCode::Disconnected, {}, 9, 0};
  RecordingBook sut;
  sut.note("right", first, "/flights/1");
  EXPECT_EQ(sut.find("right", second), "");
  EXPECT_EQ(sut.find("right", first), "/flights/1");
}

// A servo stops now and then and its status shows the newest stop; a disk, slow or quick, finishes
// recordings in their order. What is shown is that very stop's or nothing.
TEST(RecordingBook, NeverShowsTheWrongOneHoweverSlowTheDisk) {
  std::mt19937 random(244);
  RecordingBook sut;
  std::deque<Fault> unwritten;
  Fault shown{};
  std::uint64_t tick = 0;
  int written_of_shown = 0;
  for (int step = 0; step < 20000; ++step) {
    ++tick;
    if (random() % 4 == 0) {
      const bool is_latched = random() % 2 == 0;
      shown = {is_latched ? FaultCode::Estop : FaultCode::Disconnected,
               {},
               tick,
               is_latched ? shown.number + 1 : 0};
      unwritten.push_back(shown);
    }
    if (random() % 3 == 0 && !unwritten.empty()) {
      sut.note("right", unwritten.front(), std::to_string(unwritten.front().tick));
      unwritten.pop_front();
    }
    const bool is_written = shown.tick != 0 && unwritten.empty();
    EXPECT_EQ(sut.find("right", shown), is_written ? std::to_string(shown.tick) : "");
    written_of_shown += is_written ? 1 : 0;
  }
  EXPECT_GT(written_of_shown, 1000);
}

}  // namespace
}  // namespace thimble::app
