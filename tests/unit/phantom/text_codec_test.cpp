#include "drivers/phantom/text_codec.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace thimble::phantom {
namespace {

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::optional<TextReport> parse(std::string_view text) { return parse_text_report(bytes_of(text)); }

std::string encode(const std::array<double, 3>& current_a, double full_scale_a = 6) {
  const TextMessage message = encode_text_currents(current_a, full_scale_a);
  return {message.payload().begin(), message.payload().end()};
}

// All lines in `text`.
std::vector<std::string> lines_in(std::string_view text, TextLines& sut) {
  std::vector<std::string> lines;
  for (const std::uint8_t byte : bytes_of(text)) {
    const auto line = sut.take(byte);
    if (!line.empty()) lines.emplace_back(line.begin(), line.end());
  }
  return lines;
}

TEST(TextCodec, ParsesALineWrittenByHand) {
  const TextReport expected{3, {1, -2, 0, 1023, 2147483647, -2147483648}, 1024};
  EXPECT_EQ(parse("[3,1,-2,0,1023,2147483647,-2147483648,1024]"), expected);
}

TEST(TextCodec, RefusesEverythingElse) {
  for (const char* text : {"",
                           "[",
                           "]",
                           "[]",
                           "[3,1,2,3,4,5,6]",
                           "[3,1,2,3,4,5,6,7,8]",
                           "[3,1,2,3,4,5,6,7",
                           "3,1,2,3,4,5,6,7]",
                           "[3,1,2,3,4,5,6,]",
                           "[,1,2,3,4,5,6,7]",
                           "[3, 1,2,3,4,5,6,7]",
                           "[3,+1,2,3,4,5,6,7]",
                           "[3,01,2,3,4,5,6,7]",
                           "[3,-0,2,3,4,5,6,7]",
                           "[3,--1,2,3,4,5,6,7]",
                           "[3,1.5,2,3,4,5,6,7]",
                           "[3,2147483648,2,3,4,5,6,7]",
                           "[3,-2147483649,2,3,4,5,6,7]",
                           "[3,99999999999999999999,2,3,4,5,6,7]",
                           "[3,0x1,2,3,4,5,6,7]",
                           "[3,1,2,3,4,5,6,7]]",
                           "[3,1,2,3,4,5,6,7 ]",
                           "[3;1;2;3;4;5;6;7]",
                           "[-,1,2,3,4,5,6,7]"}) {
    EXPECT_EQ(parse(text), std::nullopt) << text;
  }
}

TEST(TextCodec, EveryReportComesBackFromItsLine) {
  std::mt19937 random(1);
  std::uniform_int_distribution<std::int32_t> any(std::numeric_limits<std::int32_t>::min());
  for (int i = 0; i < 2000; ++i) {
    TextReport report{any(random), {}, any(random)};
    std::string text = "[" + std::to_string(report.model);
    for (std::int32_t& counts : report.counts) {
      counts = i % 2 == 0 ? any(random) : any(random) % 100;
      text += "," + std::to_string(counts);
    }
    text += "," + std::to_string(report.error) + "]";
    ASSERT_LE(text.size(), TextLines::kMostBytes);
    ASSERT_EQ(parse(text), report) << text;
  }
}

// One letter of a line that is another one gives another value or none, never a crash; of a line
// that is cut there is never a value.
TEST(TextCodec, ALineThatIsCutIsNone) {
  const std::string whole = "[2,-104,33,5,0,1023,7,0]";
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_EQ(parse(whole.substr(0, size)), std::nullopt) << size;
    EXPECT_EQ(parse(whole.substr(whole.size() - size)), std::nullopt) << size;
  }
}

TEST(TextCodec, WritesCurrentsInMilliampereAndPadsWithNul) {
  EXPECT_EQ(encode({0, 0, 0}), std::string(" [0,0,0]\n") + std::string(7, '\0'));
  EXPECT_EQ(encode({1.2344, -0.0006, 5.9999}), " [1234,-1,6000]\n");
  EXPECT_EQ(encode({-6, -6, -6}), " [-6000,-6000,-6000]\n");
}

TEST(TextCodec, WhatIsBeyondFullScaleIsFullScaleAndWhatIsNoNumberIsZero) {
  const double nan = std::nan("");
  const double huge = std::numeric_limits<double>::max();
  EXPECT_EQ(encode({6.0001, -1e9, huge}), " [6000,-6000,6000]\n");
  EXPECT_EQ(encode({nan, HUGE_VAL, -HUGE_VAL}), encode({0, 0, 0}));
  EXPECT_TRUE(encode({9, 9, 9}, 0.29).starts_with(" [290,290,290]"));
  EXPECT_TRUE(encode({9, 9, 9}, 2.9996).starts_with(" [2999,2999,2999]")) << "never above";
  EXPECT_EQ(encode({99, -99, 99}, 32.767), " [32767,-32767,32767]\n");
}

TEST(TextCodec, NoCurrentIsEverMoreThanTheFirmwareTakes) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> full_scale(0.001, 32.767);
  std::uniform_real_distribution<double> current(-100, 100);
  for (int i = 0; i < 5000; ++i) {
    const double most_a = full_scale(random);
    const std::string text = encode({current(random), current(random), current(random)}, most_a);
    ASSERT_GE(text.size(), text::kShortestMessageBytes);
    ASSERT_LE(text.size(), text::kBufferBytes);
    std::array<int, 3> ma{};
    ASSERT_EQ(std::sscanf(text.c_str(), " [%d,%d,%d]\n", &ma[0], &ma[1], &ma[2]), 3) << text;
    for (const int value : ma) ASSERT_LE(std::abs(value), most_a * 1000 + 1e-3) << text;
  }
}

TEST(TextLines, FindsLinesWhereverTheChunksEnd) {
  TextLines sut;
  EXPECT_EQ(lines_in("[1,2]\n[3", sut), std::vector<std::string>{"[1,2]"});
  EXPECT_EQ(lines_in(",4]\r\n", sut), std::vector<std::string>{"[3,4]"});
  EXPECT_EQ(lines_in(std::string(4, '\0') + "[5]", sut), std::vector<std::string>{"[5]"});
  EXPECT_EQ(sut.lost_bytes(), 0U);
}

TEST(TextLines, FindsTheNextLineAfterAnyGarbage) {
  TextLines sut;
  EXPECT_EQ(lines_in("x]y[1,2[3]", sut), std::vector<std::string>{"[3]"});
  EXPECT_EQ(sut.lost_bytes(), 3 + 4U);
  EXPECT_TRUE(lines_in("[" + std::string(500, '7') + "]", sut).empty());
  EXPECT_EQ(lines_in("[4]", sut), std::vector<std::string>{"[4]"});
  EXPECT_TRUE(lines_in("[5,", sut).empty());
  sut.forget();
  EXPECT_TRUE(lines_in("6]", sut).empty()) << "its beginning is missing";
}

TEST(TextLines, AnyBytesAreLinesPaddingOrCountedAsLost) {
  std::mt19937 random(3);
  TextLines sut;
  std::uint64_t in_lines = 0;
  std::uint64_t padding = 0;
  std::uint64_t all = 0;
  std::uint64_t open = 0;  // of a line that is not ended
  const std::string letters = "[],-0123456789\n\r\0xyz";
  for (int i = 0; i < 100'000; ++i, ++all) {
    const auto letter = static_cast<std::uint8_t>(letters[random() % letters.size()]);
    const std::uint64_t lost = sut.lost_bytes();
    const auto line = sut.take(letter);
    ASSERT_LE(line.size(), TextLines::kMostBytes);
    in_lines += line.size();
    const bool is_begun = letter == '[' || (open > 0 && line.empty() && sut.lost_bytes() == lost);
    const bool was_outside = open == 0;
    if (letter == '[') open = 0;
    open = is_begun ? open + 1 : 0;
    if (was_outside && !is_begun && sut.lost_bytes() == lost && line.empty()) ++padding;
  }
  EXPECT_EQ(in_lines + padding + sut.lost_bytes() + open, all);
}

}  // namespace
}  // namespace thimble::phantom
