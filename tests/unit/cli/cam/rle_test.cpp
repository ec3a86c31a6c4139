#include <gtest/gtest.h>

#include <random>

#include "cli/cam/pattern.hpp"

namespace thimble::cam {
namespace {

std::string cells_text(const Pattern& pattern) {
  std::string text;
  for (std::size_t y = 0; y < pattern.size[1]; ++y) {
    for (std::size_t x = 0; x < pattern.size[0]; ++x) {
      text += pattern.cells[pattern.index_of(x, y, 0)] ? 'o' : '.';
    }
    text += '/';
  }
  return text;
}

std::string parsed(std::string_view text) {
  const auto pattern = parse_rle(text);
  return pattern ? cells_text(*pattern) : pattern.error().message;
}

TEST(Rle, AGliderIsRead) {
  EXPECT_EQ(parsed("#C a comment\n#O somebody\nx = 3, y = 3, rule = B3/S23\nbob$2bo$3o!\n"),
            ".o./..o/ooo/");
  EXPECT_EQ(parsed("x=3,y=3\nbo$\n 2bo\n$3o"), ".o./..o/ooo/");
}

TEST(Rle, RowsThatAreLeftOutAreEmpty) {
  EXPECT_EQ(parsed("x = 2, y = 4\n3$bo!"), "../../../.o/");
  EXPECT_EQ(parsed("x = 2, y = 2\n!"), "../../");
  EXPECT_EQ(parsed("x = 0, y = 0\n!"), "");
}

TEST(Rle, EveryStateButTheFirstIsSet) {
  EXPECT_EQ(parsed("x = 6, y = 1\n.A2BpAyX!"), ".ooooo/");
  EXPECT_EQ(parsed("x = 3, y = 1\nb2o!ooo"), ".oo/");
}

TEST(Rle, WhatIsNoPatternIsRefused) {
  for (const char* const text :
       {"", "\n", "#only a comment", "x = 3\nooo!", "x = , y = 3\n", "x = 3; y = 3\n!",
        "y = 1, x = 1\n", "x = -1, y = 2\n!", "x = 99999999999999999999, y = 1\n!"}) {
    const auto pattern = parse_rle(text);
    ASSERT_FALSE(pattern) << text;
    EXPECT_EQ(pattern.error().code, Errc::Malformed) << text;
  }
}

TEST(Rle, WhatGoesBeyondItsSizeIsRefused) {
  for (const char* const text :
       {"x = 2, y = 1\n3o!", "x = 2, y = 1\n2oo!", "x = 2, y = 1\no$o!", "x = 2, y = 1\n0o!",
        "x = 2, y = 1\n99999999999o!", "x = 2, y = 1\n268435456o!", "x = 2, y = 1\no?!",
        "x = 0, y = 0\no!"}) {
    EXPECT_FALSE(parse_rle(text)) << text;
  }
}

TEST(Rle, ASizeBeyondTheLimitTakesNoMemory) {
  const auto pattern = parse_rle("x = 268435456, y = 2\n!");
  ASSERT_FALSE(pattern);
  EXPECT_EQ(pattern.error().code, Errc::TooLarge);
}

TEST(Rle, WhatIsWrittenIsReadAgain) {
  std::mt19937 random(71);
  for (int i = 0; i < 100; ++i) {
    Pattern pattern{{random() % 90, random() % 20, 1}, {}};
    pattern.cells.resize(pattern.size[0] * pattern.size[1]);
    const unsigned rarity = 1 + static_cast<unsigned>(random() % 9);
    for (std::size_t n = 0; n < pattern.cells.size(); ++n)
      pattern.cells[n] = random() % rarity == 0;
    const std::string text = to_rle(pattern, "B3/S23");
    const auto again = parse_rle(text);
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->size, pattern.size);
    EXPECT_EQ(again->cells, pattern.cells);
    std::size_t line = 0;
    for (const char c : text) {
      line = c == '\n' ? 0 : line + 1;
      ASSERT_LE(line, 70U);
    }
  }
}

}  // namespace
}  // namespace thimble::cam
