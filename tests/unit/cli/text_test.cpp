#include "cli/text.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "cli/terminal.hpp"

namespace thimble::cli {
namespace {

TEST(Text, FitsToColumnsAndNotToBytes) {
  EXPECT_EQ(fit("abc", 5), "abc  ");
  EXPECT_EQ(fit("abcdef", 3), "abc");
  EXPECT_EQ(fit("1 µs", 4), "1 µs");
  EXPECT_EQ(fit("µµµ", 2), "µµ");
  EXPECT_EQ(columns_of("│·█"), 3U);
}

TEST(Text, LetsNoControlCharacterThrough) {
  EXPECT_EQ(plain("a\x1b[2Jb\n\x7f\xc3\xa4"), "a?[2Jb????");
}

TEST(Text, WrapsAtSpaces) {
  EXPECT_EQ(wrap("one two three", 9, 2), "  one two\n  three\n");
  EXPECT_EQ(wrap("abcdefghij", 6, 2), "  abcd\n  efgh\n  ij\n");
  EXPECT_EQ(wrap("", 10, 2), "");
}

TEST(Text, ShowsWhatIsNotKnownAsADash) {
  EXPECT_EQ(fixed(std::numeric_limits<double>::quiet_NaN(), 1), "-");
  EXPECT_EQ(time_text(std::numeric_limits<double>::infinity(), Glyphs::Ascii), "-");
  EXPECT_EQ(uptime_text(-1), "-");
  EXPECT_LE(signed_fixed(-1.7976931348623157e308, 2).size(), 12U);
}

TEST(Text, ChoosesTheUnitOfATime) {
  EXPECT_EQ(time_text(12.34e-6, Glyphs::Ascii), "12.3 us");
  EXPECT_EQ(time_text(12.34e-6, Glyphs::Unicode), "12.3 µs");
  EXPECT_EQ(time_text(1.5e-3, Glyphs::Ascii), "1.50 ms");
  EXPECT_EQ(time_text(2.5, Glyphs::Ascii), "2.50 s");
  EXPECT_EQ(uptime_text(3723.9), "01:02:03");
}

TEST(Text, ClampsBars) {
  EXPECT_EQ(bar(0.5, 4, Glyphs::Ascii), "##..");
  EXPECT_EQ(bar(7, 4, Glyphs::Ascii), "####");
  EXPECT_EQ(bar(-7, 4, Glyphs::Ascii), "....");
  EXPECT_EQ(bar(std::numeric_limits<double>::quiet_NaN(), 2, Glyphs::Unicode), "··");
}

TEST(Redraw, OverwritesInsteadOfErasingFirst) {
  EXPECT_EQ(redraw("a\nb\n"), "\x1b[Ha\x1b[K\r\nb\x1b[K\r\n\x1b[J");
}

}  // namespace
}  // namespace thimble::cli
