#include "daemon/servo/flight_recorder.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "daemon/servo/flight_file.hpp"

namespace thimble::servo {
namespace {

ServoFrame numbered(std::uint64_t tick) {
  ServoFrame frame;
  frame.tick = tick;
  frame.force = {1, 2, 3};
  return frame;
}

TEST(FlightRecorder, KeepsTheLastFramesOldestFirst) {
  FlightRecorder sut(5);
  for (std::uint64_t i = 1; i <= 12; ++i) sut.record(numbered(i));
  sut.freeze();

  const std::vector<ServoFrame> frames = sut.take();

  ASSERT_EQ(frames.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(frames[i].tick, 8 + i);
}

TEST(FlightRecorder, GivesNothingUntilFrozenAndStartsAnewAfterTake) {
  FlightRecorder sut(5);
  sut.record(numbered(1));
  EXPECT_TRUE(sut.take().empty());
  sut.freeze();
  sut.record(numbered(2));
  EXPECT_EQ(sut.take().size(), 1U) << "what comes after the freeze is not recorded";
  sut.record(numbered(3));
  sut.freeze();
  EXPECT_EQ(sut.take().front().tick, 3U);
}

TEST(FlightFile, NamesTheCauseAndHasARowPerTickWithAsManyFieldsAsTheHeader) {
  const FlightHeader header{"right", "sim:phantom-vintage", {FaultCode::Overspeed, {}, 7}};
  std::istringstream text(format_flight(header, {numbered(6), numbered(7)}));
  std::string line;
  std::string columns;
  std::size_t rows = 0;
  bool has_cause = false;
  while (std::getline(text, line)) {
    if (line.rfind("# cause: overspeed at tick 7", 0) == 0) has_cause = true;
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
  EXPECT_EQ(rows, 2U);
}

}  // namespace
}  // namespace thimble::servo
