#include "cli/flight/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <sstream>

#include "tests/unit/cli/flight/flight_testing.hpp"

namespace thimble::flight {
namespace {

using cli::Glyphs;
using testing::HasSubstr;
using testing::Not;

Recording recording() { return *parse_recording(written_recording()); }

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// Rows of the table, which is the last part.
std::vector<std::string> table_of(const std::string& text) {
  std::vector<std::string> lines = lines_of(text);
  const auto head = std::find_if(lines.begin(), lines.end(), [](const std::string& line) {
    return line.find("time ms") != std::string::npos;
  });
  lines.erase(lines.begin(), head + 2);
  return lines;
}

TEST(FlightReport, TellsArmCauseAndWhereInTheRecordingTheStopIs) {
  const std::string sut = render(recording(), kDefaultBefore_s, Glyphs::Ascii);
  EXPECT_THAT(sut, HasSubstr("arm     right  sim:phantom-vintage\n"));
  EXPECT_THAT(sut, HasSubstr("cause   overspeed at tick 1180\n"));
  EXPECT_THAT(sut, HasSubstr("200 ticks, 0.199 s; the fault 0.180 s in\n"));
}

TEST(FlightReport, ShowsTheFiftyMillisecondsBeforeTheStopAndTwoTicksAfterIt) {
  const auto sut = table_of(render(recording(), kDefaultBefore_s, Glyphs::Ascii));
  ASSERT_EQ(sut.size(), kMaxRows);
  EXPECT_THAT(sut.front(), HasSubstr("-50.0 active"));
  EXPECT_THAT(sut.back(), HasSubstr("2.0 fault"));
  EXPECT_THAT(sut.back(), HasSubstr("overspeed"));
  EXPECT_EQ(table_of(render(recording(), 0, Glyphs::Ascii)).size(), 3U);
}

TEST(FlightReport, NeverLeavesOutTheTickThatFailed) {
  const auto sut = table_of(render(recording(), 60, Glyphs::Ascii));
  EXPECT_EQ(sut.size(), kMaxRows);
  EXPECT_TRUE(std::ranges::any_of(
      sut, [](const std::string& row) { return row.find("  0.0 fault") != std::string::npos; }));
}

TEST(FlightReport, PlotsTheForceUntilItWasCut) {
  const auto sut = lines_of(render(recording(), 0, Glyphs::Ascii));
  const auto title = std::find(sut.begin(), sut.end(), "force sent, N");
  ASSERT_NE(title, sut.end());
  const std::string top = *(title + 1);
  const std::string bottom = *(title + 6);
  EXPECT_THAT(top, HasSubstr("1.79 "));
  EXPECT_EQ(top.substr(10).find('#'), 48U) << "5/6 of 1.79 N are reached after 150 ticks of 200";
  EXPECT_EQ(bottom.substr(10).find_last_of('#'), 57U) << "cut after 180 of 200";
}

TEST(FlightReport, MarksAForceThatIsNoNumber) {
  Recording broken = recording();
  broken.samples[100].force.x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(render(broken, 0, Glyphs::Ascii), HasSubstr("?"));
  EXPECT_THAT(render(recording(), 0, Glyphs::Ascii), Not(HasSubstr("?")));
}

TEST(FlightReport, TakesTheEndForTheStopWhenNoTickHasAFault) {
  Recording calm = recording();
  calm.samples.resize(10);
  const auto sut = table_of(render(calm, 0.003, Glyphs::Ascii));
  ASSERT_EQ(sut.size(), 4U);
  EXPECT_THAT(sut.back(), HasSubstr("0.0 active"));
}

TEST(FlightReport, FitsATerminalWhateverTheFileSays) {
  Recording hostile = recording();
  const std::string noise = "\x1b[2J" + std::string(300, 'x');
  hostile.arm = hostile.device = hostile.cause = hostile.meaning = noise;
  for (Sample& sample : hostile.samples) {
    sample.state = sample.read = sample.fault = noise;
    sample.now_s = 1e300;
    sample.force.x = 1e300;
  }
  for (const std::string& line : lines_of(render(hostile, 60, Glyphs::Ascii))) {
    EXPECT_LE(line.size(), 80U) << line;
    EXPECT_TRUE(std::ranges::all_of(line, [](char c) { return c >= 0x20 && c < 0x7F; })) << line;
  }
  for (const std::string& line : lines_of(render(recording(), 60, Glyphs::Unicode))) {
    EXPECT_LE(cli::columns_of(line), 80U) << line;
  }
}

}  // namespace
}  // namespace thimble::flight
