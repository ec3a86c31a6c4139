#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/config/config_testing.hpp"

namespace thimble::config {
namespace {

using testing::HasSubstr;

TEST(ConfigPlugins, AreNamedByAbsolutePathsOnly) {
  const auto plugins = [](const std::string& value) {
    const auto found = mistakes("[daemon]\nplugins = " + value + "\n" + std::string(kHello));
    return found.empty() ? "" : found.front();
  };
  EXPECT_EQ(plugins("[]"), "");
  EXPECT_EQ(plugins("['/a.so']"), "");
  EXPECT_THAT(plugins("['/a.so', 'b.so']"), HasSubstr("expected absolute paths, found \"b.so\""));
  EXPECT_THAT(plugins("'/a.so'"), HasSubstr("expected an array of at most 16 strings, found"));
  EXPECT_THAT(plugins("['/a.so', 7]"), HasSubstr("expected a string, found 7"));
  EXPECT_THAT(plugins("['/a.so', '']"), HasSubstr("expected a string that is not empty"));
  EXPECT_THAT(plugins("[\"/a\\u0000.so\"]"), HasSubstr("without zero bytes"));
  std::string many = "['/0'";
  for (int i = 1; i < 17; ++i) many += ", '/" + std::to_string(i) + "'";
  EXPECT_THAT(plugins(many + "]"), HasSubstr("found an array"));
}

}  // namespace
}  // namespace thimble::config
