#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>

#include "daemon/config/load.hpp"

namespace thimble::config {
namespace {

std::string read_page() {
  std::ifstream file(THIMBLE_SOURCE_DIR "/docs/configuration.md");
  return {std::istreambuf_iterator<char>(file), {}};
}

bool is_table(const std::string& key) {
  const auto keys = schema_keys();
  return std::any_of(keys.begin(), keys.end(),
                     [&](const std::string& other) { return other.starts_with(key + "."); });
}

TEST(ConfigSchema, ListsKeysOfEveryTable) {
  const auto sut = schema_keys();
  for (const char* key : {"daemon", "servo.rate_hz", "arm.limits.ramp_s", "arm.hand.motion",
                          "world.impairment.seed", "world.peer"}) {
    EXPECT_EQ(std::count(sut.begin(), sut.end(), key), 1) << key;
  }
  EXPECT_GT(sut.size(), 50U);
}

TEST(ConfigurationPage, DescribesEveryKey) {
  const std::string page = read_page();
  ASSERT_FALSE(page.empty());
  for (const std::string& key : schema_keys()) {
    const bool is_found = page.find("`" + key + "`") != std::string::npos ||
                          (is_table(key) && page.find("[" + key + "]") != std::string::npos);
    EXPECT_TRUE(is_found) << key;
  }
}

TEST(ConfigurationPage, DescribesNoKeyThatDoesNotExist) {
  const auto keys = schema_keys();
  const std::set<std::string> known(keys.begin(), keys.end());
  const std::string page = read_page();
  const std::regex row("\\n\\| `([a-z_.]+)`");
  int rows = 0;
  for (auto it = std::sregex_iterator(page.begin(), page.end(), row); it != std::sregex_iterator();
       ++it, ++rows) {
    EXPECT_TRUE(known.contains((*it)[1])) << (*it)[1];
  }
  EXPECT_GT(rows, 40);
}

}  // namespace
}  // namespace thimble::config
