#include "cli/flight/recording.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/cli/flight/flight_testing.hpp"

namespace thimble::flight {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

std::string refusal(const std::string& text) {
  const auto sut = parse_recording(text);
  return sut ? "taken" : sut.error().message;
}

TEST(FlightRecording, ReadsWhatTheServoWrote) {
  const auto sut = parse_recording(written_recording());
  ASSERT_TRUE(sut) << sut.error().message;
  EXPECT_EQ(sut->arm, "right");
  EXPECT_EQ(sut->device, "sim:phantom-vintage");
  EXPECT_EQ(sut->cause, "overspeed at tick 1180");
  EXPECT_THAT(sut->meaning, testing::Not(testing::IsEmpty()));
  ASSERT_EQ(sut->samples.size(), 200U);
  const Sample& before = sut->samples[178];
  EXPECT_EQ(before.tick, 1178U);
  EXPECT_NEAR(before.now_s, 5.178, 1e-9);
  EXPECT_NEAR(before.lateness_s, 20e-6, 1e-9);
  EXPECT_EQ(before.state, to_string(OperatingState::Active));
  EXPECT_EQ(before.read, to_string(IoStatus::Ok));
  EXPECT_EQ(before.fault, to_string(FaultCode::None));
  EXPECT_NEAR(norm(before.velocity), 0.5, 1e-6);
  EXPECT_NEAR(norm(before.offset), 0.002, 1e-9);
  EXPECT_NEAR(norm(before.wish), 1.78, 1e-6);
  EXPECT_NEAR(norm(before.force), 1.78, 1e-6);
  EXPECT_TRUE(before.is_in_contact);
  EXPECT_FALSE(sut->samples[179].is_in_contact);
  EXPECT_EQ(sut->samples[180].fault, "overspeed");
}

TEST(FlightRecording, TakesNumbersThatAreNone) {
  const auto sut = parse_recording(replaced(written_recording(), ",0.01,0,0,", ",nan,-nan,inf,"));
  ASSERT_TRUE(sut) << sut.error().message;
  EXPECT_TRUE(std::isnan(sut->samples[1].wish.x));
  EXPECT_TRUE(std::isinf(sut->samples[1].wish.z));
}

TEST(FlightRecording, ReadsAVersionWithMoreColumnsInAnotherOrder) {
  std::string text = written_recording();
  text = text.substr(0, text.find("\n1001,") + 1);
  text = replaced(replaced(text, "\ntick,", "\nnew,tick,"), "\n1000,", "\nx,1000,");
  const auto sut = parse_recording(text);
  ASSERT_TRUE(sut) << sut.error().message;
  EXPECT_EQ(sut->samples.at(0).tick, 1000U);
}

TEST(FlightRecording, SaysLineAndColumnOfWhatIsWrong) {
  const std::string good = written_recording();
  EXPECT_THAT(refusal(""), HasSubstr("holds no ticks"));
  EXPECT_THAT(refusal("a letter\n"), StartsWith("line 1: expected \"# Thimble flight recording"));
  EXPECT_THAT(refusal(replaced(good, "version 1", "version 2")), StartsWith("line 1: "));
  EXPECT_EQ(refusal(replaced(good, ",lateness_s,", ",late,")),
            "line 6: expected a column lateness_s");
  EXPECT_EQ(refusal(replaced(good, "\n1000,", "\n1000,1,")), "line 7: expected 34 columns");
  EXPECT_EQ(refusal(replaced(good, "\n1001,", "\n-1,")), "line 8: expected a number for tick");
  EXPECT_EQ(refusal(replaced(good, "\n1001,5.001000000,", "\n1001,5.0x,")),
            "line 8: expected a number for now_s");
  EXPECT_EQ(refusal(good.substr(0, good.find("\n1000,") + 1)), "holds no ticks");
}

TEST(FlightRecording, BoundsWhatItReads) {
  const std::string title = "# Thimble flight recording, version 1\n";
  EXPECT_THAT(refusal(std::string(kMaxFileBytes + 1, '#')), HasSubstr("more than 16777216 bytes"));
  EXPECT_THAT(refusal(title + std::string(1 << 20, ',')), HasSubstr("fewer columns"));
}

}  // namespace
}  // namespace thimble::flight
