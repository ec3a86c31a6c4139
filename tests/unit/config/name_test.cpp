#include "daemon/config/name.hpp"

#include <gtest/gtest.h>

#include <string>

namespace thimble::config {
namespace {

TEST(Name, IsOfFewPlainLetters) {
  for (const char* text : {"right", "a", "9", "-", "arm-2"}) EXPECT_TRUE(is_name(text)) << text;
  for (const char* text :
       {"", " ", "x y", "Right", "a/b", "a.b", "a%00", "a\x1b[31m", "\xc3\xa9"}) {
    EXPECT_FALSE(is_name(text)) << text;
  }
  EXPECT_TRUE(is_name(std::string(kMaxNameBytes, 'x')));
  EXPECT_FALSE(is_name(std::string(kMaxNameBytes + 1, 'x')));
  EXPECT_FALSE(is_name(std::string(1, '\0')));
}

}  // namespace
}  // namespace thimble::config
