#include "daemon/config/report.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>

namespace thimble::config {
namespace {

TEST(Escaped, LeavesLettersOfAnyLanguage) {
  for (const char* text : {"", "plain ~", "\u00e9\u2026\u201c\u2070", "\u4e2d\u6587 \U0001f600"}) {
    EXPECT_EQ(escaped(text), text);
  }
}

TEST(Escaped, ShowsWhatSteersATerminalOrEndsALine) {
  EXPECT_EQ(escaped("\x1b[2J\n\x7f"), "\\x1b[2J\\x0a\\x7f");
  EXPECT_EQ(escaped(std::string("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(escaped("\u009b2J"), "\\xc2\\x9b2J");
  EXPECT_EQ(escaped("a\u2028b\u2029"), "a\\xe2\\x80\\xa8b\\xe2\\x80\\xa9");
}

TEST(Escaped, ShowsWhatTurnsLettersRound) {
  EXPECT_EQ(escaped("\u202eb"), "\\xe2\\x80\\xaeb");
  EXPECT_EQ(escaped("\u2067b\u2069"), "\\xe2\\x81\\xa7b\\xe2\\x81\\xa9");
  EXPECT_EQ(escaped("\u200e\u200f"), "\\xe2\\x80\\x8e\\xe2\\x80\\x8f");
}

TEST(Escaped, TakesBytesThatAreNoText) {
  for (const char* text : {"\xe2", "\xe2\x80", "\xe2\x81", "\xc2", "\x80\x9b", "\xff\xfe"}) {
    EXPECT_EQ(escaped(text), text);
  }
}

// Of whatever bytes: nothing below a blank is left, and who unescapes has what was there.
TEST(Escaped, LosesNothing) {
  std::mt19937 chance(1);
  for (int i = 0; i < 2000; ++i) {
    std::string text(chance() % 20, '\0');
    for (char& letter : text) letter = static_cast<char>(chance() % 4 == 0 ? chance() : 'a');
    std::replace(text.begin(), text.end(), '\\', 'a');  // it would be taken for a code
    std::string shown = escaped(text);
    std::string back;
    for (std::size_t k = 0; k < shown.size(); ++k) {
      EXPECT_TRUE(static_cast<unsigned char>(shown[k]) >= 0x20 && shown[k] != 0x7F);
      const bool is_code = shown.compare(k, 2, "\\x") == 0;
      back +=
          is_code ? static_cast<char>(std::stoi(shown.substr(k + 2, 2), nullptr, 16)) : shown[k];
      if (is_code) k += 3;
    }
    EXPECT_EQ(back, text);
  }
}

}  // namespace
}  // namespace thimble::config
