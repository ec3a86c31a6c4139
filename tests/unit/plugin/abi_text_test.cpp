#include "hal/plugin/abi_text.hpp"

#include <gtest/gtest.h>

#include <boost/json.hpp>
#include <cstring>
#include <random>

namespace thimble::plugin {
namespace {

// A judge of its own: JSON takes no other bytes.
bool is_json_text(const std::string& text) {
  boost::system::error_code error;
  boost::json::parse(boost::json::serialize(boost::json::string(text)), error);
  return !error;
}

TEST(PluginText, StaysAsItIsWhereItIsPlain) {
  for (const char* text : {"", "a", "Grüße", "5 µm", "触れる", "\xF4\x8F\xBF\xBF", "\xC2\xA0"}) {
    EXPECT_EQ(plain_utf8(text), text);
  }
}

TEST(PluginText, HasAQuestionMarkForWhatIsNone) {
  EXPECT_EQ(plain_utf8("a\x80z"), "a?z");
  EXPECT_EQ(plain_utf8("\xFF\xFE"), "??");
  EXPECT_EQ(plain_utf8("\xC0\xAF"), "??") << "a longer form of /";
  EXPECT_EQ(plain_utf8("\xED\xA0\x80"), "???") << "half a pair";
  EXPECT_EQ(plain_utf8("\xF4\x90\x80\x80"), "????") << "beyond Unicode";
  EXPECT_EQ(plain_utf8("\xE2\x82"), "??") << "cut off";
  EXPECT_EQ(plain_utf8("a\n\x1B[2J\x7F"), "a??[2J?");
  EXPECT_EQ(plain_utf8("\xC2\x9B"
                       "2J"),
            "?2J")
      << "a terminal's command in one character";
}

TEST(PluginText, OfAnyBytesIsJsonWithoutControls) {
  std::mt19937 random(3);
  const std::string pieces[] = {"\xC3", "\xBC", "\xE2\x82\xAC", "\xF0\x9F", "\x98\x80", "z"};
  for (int round = 0; round < 20000; ++round) {
    char array[24];
    std::string bytes;
    while (bytes.size() < sizeof(array)) {
      if (random() % 2 == 0) {
        bytes += pieces[random() % std::size(pieces)];
      } else {
        bytes += static_cast<char>(random() % 256);
      }
    }
    std::memcpy(array, bytes.data(), sizeof(array));
    const std::string text = text_of(array);
    ASSERT_TRUE(is_json_text(text)) << round;
    ASSERT_EQ(plain_utf8(text), text) << round;
    ASSERT_LE(text.size(), sizeof(array));
    for (const char c : text) ASSERT_TRUE(static_cast<unsigned char>(c) >= 0x20 && c != 0x7F);
  }
}

TEST(PluginText, ForThePluginIsCutBetweenCharacters) {
  char array[5];
  put_text("abc\xC3\xBC", array);
  EXPECT_STREQ(array, "abc");
  put_text("ab\xC3\xBC", array);
  EXPECT_STREQ(array, "ab\xC3\xBC");
  put_text("\x80\x80\x80\x80\x80", array);
  EXPECT_EQ(array[4], '\0');
}

}  // namespace
}  // namespace thimble::plugin
