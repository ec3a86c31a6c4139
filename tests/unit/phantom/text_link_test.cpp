#include "drivers/phantom/text_link.hpp"

#include <gtest/gtest.h>

#include <deque>
#include <string>
#include <vector>

#include "drivers/phantom/find_model.hpp"

namespace thimble::phantom {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

// What a test says of a port and what it sees; outlives the port that a link owns.
struct SerialScript : Clock {
  std::deque<std::string> chunks;
  std::vector<std::string> submitted;
  bool is_connected{true};
  IoStatus submits_as{IoStatus::Ok};
  MonotonicTime time{milliseconds(1000)};
  std::uint64_t sequence{0};
  [[nodiscard]] MonotonicTime now() const noexcept override { return time; }
  Duration sleep_until(MonotonicTime) noexcept override { return {}; }
};

class ScriptedSerial final : public bus::SerialPort {
 public:
  explicit ScriptedSerial(SerialScript& script) : script_(script) {}
  IoStatus read(bus::SerialChunk& out) noexcept override {
    if (!script_.is_connected) return IoStatus::Disconnected;
    if (script_.chunks.empty()) return IoStatus::NoData;
    const std::string text = script_.chunks.front();
    script_.chunks.pop_front();
    std::copy(text.begin(), text.end(), out.bytes.begin());
    out.size = text.size();
    out.arrived_at = script_.time;
    out.sequence = ++script_.sequence;
    return IoStatus::Ok;
  }
  IoStatus submit(std::span<const std::uint8_t> message) noexcept override {
    if (!script_.is_connected) return IoStatus::Disconnected;
    script_.submitted.emplace_back(message.begin(), message.end());
    return script_.submits_as;
  }
  [[nodiscard]] bus::SerialCounters counters() const noexcept override { return {}; }

 private:
  SerialScript& script_;
};

struct TextLinkTest : testing::Test {
  SerialScript script;
  std::unique_ptr<TextLink> sut = std::make_unique<TextLink>(
      std::make_unique<ScriptedSerial>(script), *find_model("phantom-vintage"), 3, script);
  ControllerReport report;

  IoStatus hear(const std::string& text, Duration after = milliseconds(1)) {
    script.time = script.time + after;
    script.chunks.push_back(text);
    return sut->read(report);
  }
  IoStatus hear_counts(int a, int b, int c) {
    return hear("[2," + std::to_string(a) + "," + std::to_string(b) + "," + std::to_string(c) +
                ",0,0,0,0]\n");
  }
};

TEST_F(TextLinkTest, ALineIsAReportWithItsTimeAndNumber) {
  ASSERT_EQ(hear("[2,10,-20,30,1,2,1023,0]\n"), IoStatus::Ok);
  EXPECT_EQ(report.values.base_counts, (std::array<std::int16_t, 3>{10, -20, 30}));
  EXPECT_EQ(report.values.gimbal_counts, (std::array<std::int16_t, 3>{1, 2, 1023}));
  EXPECT_EQ(report.arrived_at, script.time);
  EXPECT_EQ(report.sequence, 1U);
  EXPECT_EQ(sut->read(report), IoStatus::NoData);
}

TEST_F(TextLinkTest, TheNewestOfSeveralLinesWinsAndALineMayComeInPieces) {
  script.chunks = {"[2,1,0,0,0,0,0,0]\n[2,2,0,0,", "0,0,0,0]\n[2,3,"};
  ASSERT_EQ(sut->read(report), IoStatus::Ok);
  EXPECT_EQ(report.values.base_counts[0], 2);
  EXPECT_EQ(report.sequence, 2U);
  EXPECT_EQ(sut->counters().reports_skipped, 1U);
  EXPECT_EQ(hear("0,0,0,0,0,0]"), IoStatus::Ok);
  EXPECT_EQ(report.values.base_counts[0], 3);
}

TEST_F(TextLinkTest, ALostChunkTearsTheLineThatItWasIn) {
  EXPECT_EQ(hear("[2,1,2,3"), IoStatus::NoData);
  ++script.sequence;
  EXPECT_EQ(hear("4,5,6,0,0,0,0]"), IoStatus::ProtocolError) << "it would look like a whole line";
}

TEST_F(TextLinkTest, WhatIsNoSampleIsToldAndCounted) {
  std::uint64_t malformed = 0;
  for (const char* text : {"garbage", "[2,1,2,3]\n", "[2,1,2,3,4,5,6,8]\n", "[2,1,2,3,4,5,6,128]\n",
                           "[2,1,2,3,4,5,6,256]\n", "[2,1,2,3,4,5,6,512]\n",
                           "[2,1,2,3,4,5,6,1024]\n", "[2,1,2,3,4,5,6,16]\n", "[2,1,2,3,4,5,6,-1]\n",
                           "[2,32768,2,3,4,5,6,0]\n", "[2,1,2,3,4,5,-40000,0]\n"}) {
    EXPECT_EQ(hear(text), IoStatus::ProtocolError) << text;
    EXPECT_EQ(sut->counters().malformed, ++malformed) << text;
  }
  EXPECT_EQ(sut->counters().reports_in, 0U);
  EXPECT_EQ(sut->trouble(), "");
  EXPECT_EQ(hear("[2,1,2,3,4,5,6,7]\n"), IoStatus::Ok) << "sensors of the gimbal only";
}

TEST_F(TextLinkTest, AnotherArmIsNoSampleAndAPersonIsToldWhatToDo) {
  for (const char* model : {"[1", "[3", "[0", "[-2"}) {
    EXPECT_EQ(hear(std::string(model) + ",1,2,3,0,0,0,0]\n"), IoStatus::ProtocolError);
    EXPECT_NE(sut->trouble().find("phantom-vintage"), std::string_view::npos);
    EXPECT_NE(sut->trouble().find("model"), std::string_view::npos);
  }
  EXPECT_EQ(hear_counts(1, 2, 3), IoStatus::Ok);
  EXPECT_EQ(sut->trouble(), "");
}

TEST_F(TextLinkTest, OneMessageIsUnderWayUntilItIsAnswered) {
  EXPECT_EQ(sut->write_currents({1, 0, 0}), IoStatus::Ok);
  for (int i = 0; i < 3; ++i) {
    script.time = script.time + milliseconds(1);
    EXPECT_EQ(sut->write_currents({2, 0, 0}), IoStatus::Backlogged);
  }
  EXPECT_EQ(script.submitted.size(), 1U);
  EXPECT_EQ(hear_counts(0, 0, 0), IoStatus::Ok);
  EXPECT_EQ(sut->write_currents({2, 0, 0}), IoStatus::Ok);
  ASSERT_EQ(script.submitted.size(), 2U);
  EXPECT_TRUE(script.submitted.back().starts_with(" [2000,0,0]\n"));
}

TEST_F(TextLinkTest, ARefusalIsAnAnswerToo) {
  EXPECT_EQ(sut->write_currents({1, 0, 0}), IoStatus::Ok);
  EXPECT_EQ(hear("[2,0,0,0,0,0,0,8]\n"), IoStatus::ProtocolError);
  EXPECT_EQ(sut->write_currents({1, 0, 0}), IoStatus::Ok);
}

TEST_F(TextLinkTest, WithoutAnAnswerItAsksAgainAfterItsPatience) {
  EXPECT_EQ(sut->write_currents({}), IoStatus::Ok);
  script.time = script.time + TextLink::kPatience - microseconds(1);
  EXPECT_EQ(sut->write_currents({}), IoStatus::Backlogged);
  script.time = script.time + microseconds(1);
  EXPECT_EQ(sut->write_currents({}), IoStatus::Ok);
}

TEST_F(TextLinkTest, AZeroOvertakesACurrentWithoutItsAnswerAndOnlyOnce) {
  EXPECT_EQ(sut->write_currents({1, 0, 0}), IoStatus::Ok);
  EXPECT_EQ(sut->write_currents({}), IoStatus::Ok);
  ASSERT_EQ(script.submitted.size(), 2U);
  EXPECT_TRUE(script.submitted.back().starts_with(" [0,0,0]\n"));
  EXPECT_EQ(sut->write_currents({}), IoStatus::Backlogged) << "a zero is under way already";
  EXPECT_EQ(hear("[2,0,0,0,0,0,0,8]\n"), IoStatus::ProtocolError) << "found with the zero";
  EXPECT_EQ(sut->write_currents({1, 0, 0}), IoStatus::Backlogged) << "the zero's answer is owed";
  EXPECT_EQ(hear_counts(0, 0, 0), IoStatus::Ok);
  EXPECT_EQ(sut->write_currents({1, 0, 0}), IoStatus::Ok);
}

TEST_F(TextLinkTest, AZeroThatTookACurrentsPlaceHasTheOnlyAnswer) {
  EXPECT_EQ(sut->write_currents({1, 0, 0}), IoStatus::Ok);
  script.submits_as = IoStatus::Backlogged;
  EXPECT_EQ(sut->write_currents({}), IoStatus::Backlogged);
  ASSERT_EQ(script.submitted.size(), 2U);
  EXPECT_EQ(hear_counts(0, 0, 0), IoStatus::Ok);
  script.submits_as = IoStatus::Ok;
  EXPECT_EQ(sut->write_currents({1, 0, 0}), IoStatus::Ok);
}

TEST_F(TextLinkTest, TellsWhereAPressWouldNotBeSeen) {
  for (const int counts : {0, 23, -23}) {
    ASSERT_EQ(hear_counts(counts, 0, 0), IoStatus::Ok);
    EXPECT_TRUE(sut->is_press_unseen()) << counts;
  }
  for (const int counts : {24, -24, 700}) {
    ASSERT_EQ(hear_counts(0, 0, counts), IoStatus::Ok);
    EXPECT_FALSE(sut->is_press_unseen()) << counts;
  }
}

TEST_F(TextLinkTest, TheLastThatIsSentIsZeroThoughAnAnswerIsOwed) {
  EXPECT_EQ(sut->write_currents({1, 1, 1}), IoStatus::Ok);
  sut.reset();
  ASSERT_EQ(script.submitted.size(), 2U);
  EXPECT_TRUE(script.submitted.back().starts_with(" [0,0,0]\n"));
}

TEST_F(TextLinkTest, CurrentsAreHeldWithinTheFirmwaresFullScale) {
  EXPECT_EQ(sut->write_currents({3.5, -100, 2.9}), IoStatus::Ok);
  EXPECT_TRUE(script.submitted.back().starts_with(" [3000,-3000,2900]\n"));
}

TEST_F(TextLinkTest, APressIsAFlagUntilTheCountersWereAskedToBeZero) {
  for (int i = 0; i < 30; ++i) ASSERT_EQ(hear_counts(700, 3, 3), IoStatus::Ok);
  EXPECT_FALSE(report.values.is_calibration_pressed);
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(hear_counts(0, 0, 1), IoStatus::Ok);
    EXPECT_TRUE(report.values.is_calibration_pressed);
  }
  EXPECT_EQ(sut->zero_counters(), IoStatus::Ok);
  EXPECT_TRUE(script.submitted.back().starts_with(" [0,0,0]\n"));
  ASSERT_EQ(hear_counts(0, 0, 1), IoStatus::Ok);
  EXPECT_FALSE(report.values.is_calibration_pressed);
}

TEST_F(TextLinkTest, ADeadPortIsDisconnected) {
  script.is_connected = false;
  EXPECT_EQ(sut->read(report), IoStatus::Disconnected);
  EXPECT_EQ(sut->write_currents({}), IoStatus::Disconnected);
  EXPECT_EQ(sut->zero_counters(), IoStatus::Disconnected);
}

TEST_F(TextLinkTest, TheGuardsZeroIsAWholeMessageOfZeros) {
  const ZeroCommand zero = sut->zero_command();
  EXPECT_EQ(zero.endpoint, 0);
  EXPECT_EQ(std::string(zero.bytes.begin(), zero.bytes.end()),
            std::string(" [0,0,0]\n") + std::string(7, '\0'));
}

}  // namespace
}  // namespace thimble::phantom
