#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/unit/config/config_testing.hpp"

namespace thimble::config {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

std::string with_safety(const std::string& lines) {
  return "[safety]\n" + lines + std::string(kHello);
}

TEST(ConfigSafety, IsNotThereUnlessItIsWritten) {
  EXPECT_FALSE(parse_text(kHello)->safety.has_value());
}

TEST(ConfigSafety, NeedsAChipAndAButton) {
  const auto sut = parse_text(with_safety("chip = \"cp2112_gpio\"\nestop = [\"0\"]\n"));
  ASSERT_TRUE(sut);
  SafetyConfig expected;
  expected.chip = "cp2112_gpio";
  expected.estop = {"0"};
  EXPECT_EQ(sut->safety, expected);
  EXPECT_EQ(expected.closed_level, ClosedLevel::Low) << "a broken wire is pulled up: open";
}

TEST(ConfigSafety, ReadsEveryKey) {
  const auto sut = parse_text(with_safety(
      "chip = \"pinctrl-bcm2711\"\nestop = [\"GPIO17\", \"GPIO27\"]\ndeadman = \"22\"\n"
      "enable = \"23\"\nlamp = \"GPIO24\"\nclosed_level = \"high\"\npull = \"external\"\n"));
  ASSERT_TRUE(sut);
  const SafetyConfig expected{"pinctrl-bcm2711", {"GPIO17", "GPIO27"},  "22", "23", "GPIO24",
                              ClosedLevel::High, PullResistor::External};
  EXPECT_EQ(sut->safety, expected);
}

TEST(ConfigSafety, WithoutAnArmItHasNothingToKeepSafe) {
  EXPECT_THAT(
      mistakes("[safety]\nchip = \"c\"\nestop = [\"0\"]\n[[world]]\nname = \"w\"\nsource = "
               "\"box:3\"\n"),
      ElementsAre(AllOf(HasSubstr("t.toml:1:"), HasSubstr(" safety: "), HasSubstr("[[arm]]"))));
}

struct BadSafety {
  const char* lines;
  const char* line;
  const char* key;
  const char* expected;
};
class BadSafetyTable : public testing::TestWithParam<BadSafety> {};

TEST_P(BadSafetyTable, IsRefusedWithItsLineAndKey) {
  EXPECT_THAT(mistakes(with_safety(GetParam().lines)),
              ElementsAre(AllOf(HasSubstr(GetParam().line), HasSubstr(GetParam().key),
                                HasSubstr(GetParam().expected))));
}

INSTANTIATE_TEST_SUITE_P(
    Each, BadSafetyTable,
    testing::Values(
        BadSafety{"estop = [\"0\"]\n", "t.toml:1:", "safety.chip: ", "no such key"},
        BadSafety{"chip = \"c\"\n", "t.toml:1:", "safety.estop: ", "no such key"},
        BadSafety{"chip = \"c\"\nestop = []\n", "t.toml:3:", "safety.estop: ", "found none"},
        BadSafety{"chip = \"c\"\nestop = [\"0\", \"1\", \"2\"]\n",
                  "t.toml:3:", "safety.estop: ", "2 strings"},
        BadSafety{"chip = \"c\"\nestop = \"0\"\n", "t.toml:3:", "safety.estop: ", "array"},
        BadSafety{"chip = \"c\"\nestop = [0]\n", "t.toml:3:", "safety.estop: ", "0"},
        BadSafety{"chip = \"c\"\nestop = [\"0\", \"0\"]\n",
                  "t.toml:3:", "safety.estop: ", "of its own"},
        BadSafety{"chip = \"c\"\nestop = [\"0\"]\nlamp = \"0\"\n",
                  "t.toml:4:", "safety.lamp: ", "again"},
        BadSafety{"chip = \"c\"\nestop = [\"0\"]\nenable = \"4\"\ndeadman = \"4\"\n",
                  "t.toml:4:", "safety.enable: ", "again"},
        BadSafety{"chip = \"c\"\nestop = [\"0\"]\nclosed_level = \"open\"\n",
                  "t.toml:4:", "safety.closed_level: ", "\"low\""},
        BadSafety{"chip = \"c\"\nestop = [\"0\"]\npull = \"up\"\n",
                  "t.toml:4:", "safety.pull: ", "\"internal\""},
        BadSafety{"chip = \"c\"\nestop = [\"0\"]\nestopp = 1\n",
                  "t.toml:4:", "safety.estopp: ", "estop"},
        BadSafety{"chip = \"c\\nd\"\nestop = [\"0\"]\n",
                  "t.toml:2:", "safety.chip: ", "31 characters"},
        BadSafety{"chip = \"c\"\nestop = [\"abcdefghijklmnopqrstuvwxyz0123456789\"]\n",
                  "t.toml:3:", "safety.estop: ", "31 characters"}));

}  // namespace
}  // namespace thimble::config
