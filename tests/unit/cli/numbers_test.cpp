#include "cli/numbers.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <string>

namespace thimble::cli {
namespace {

constexpr std::uint64_t kMost = std::numeric_limits<std::uint64_t>::max();

TEST(WholeNumber, IsTakenInPlainDigitsWithinItsBounds) {
  EXPECT_EQ(refuse_whole_number("0", 0, 9), "");
  EXPECT_EQ(refuse_whole_number("9", 0, 9), "");
  EXPECT_EQ(refuse_whole_number("18446744073709551615", 0, kMost), "");
  EXPECT_NE(refuse_whole_number("0", 1, 9), "");
  EXPECT_NE(refuse_whole_number("10", 1, 9), "");
  EXPECT_NE(refuse_whole_number("18446744073709551616", 0, kMost), "");
  for (const char* text : {"", " ", "-1", "-0", "+1", "010", "00", "0x10", "1 ", " 1", "1.0", "1e3",
                           "true", "one", "1'000"}) {
    EXPECT_NE(refuse_whole_number(text, 0, kMost), "") << text;
  }
}

TEST(WholeNumber, MayBeAnyOf64Bits) {
  for (const char* text : {"0", "1", "18446744073709551615"}) {
    EXPECT_EQ(refuse_other_than_whole(text), "") << text;
  }
  for (const char* text : {"", "-1", "010", "0x10", "18446744073709551616", "nan"}) {
    EXPECT_NE(refuse_other_than_whole(text), "") << text;
  }
}

TEST(WholeNumber, IsASeedAsLongAsAFileOfFindingsGivesItBack) {
  for (const char* text : {"0", "1", "9007199254740992"}) {
    EXPECT_EQ(refuse_other_than_seed(text), "") << text;
    EXPECT_EQ(static_cast<std::uint64_t>(std::stod(text)), std::stoull(text)) << text;
  }
  for (const char* text : {"9007199254740993", "18446744073709551615", "010", "-1", ""}) {
    EXPECT_NE(refuse_other_than_seed(text), "") << text;
  }
}

TEST(WholeNumber, IsRefusedWithTheBoundsAndWithoutControlBytes) {
  EXPECT_EQ(refuse_whole_number("\x1b[31m", 1, 9),
            "expected a whole number from 1 to 9, found \"?[31m\"");
}

TEST(WholeNumber, IsWhatPrintingItWouldGive) {
  std::mt19937_64 chance(1);
  for (int i = 0; i < 10000; ++i) {
    const std::uint64_t number = chance() >> (chance() % 64);
    const std::uint64_t most = chance() >> (chance() % 64);
    EXPECT_EQ(refuse_whole_number(std::to_string(number), 0, most).empty(), number <= most);
  }
}

TEST(FiniteNumber, IsTakenWholeOrRefused) {
  for (const char* text : {"0", "-0.5", "+.5", "-.01", "2e-3", "1.", "-1e300", "010"}) {
    EXPECT_EQ(refuse_finite_number(text), "") << text;
  }
  for (const char* text : {"", " ", "nan", "-nan", "inf", "-inf", "1e999", "0.1x", " 1", "+-1",
                           "++1", "--1", "0x10", ".", "-", "+", "e3"}) {
    EXPECT_NE(refuse_finite_number(text), "") << text;
  }
}

}  // namespace
}  // namespace thimble::cli
