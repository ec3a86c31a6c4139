#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/unit/config/config_testing.hpp"

namespace thimble::config {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

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

TEST(ConfigSafety, SaysWhetherItsChipIsSimulated) {
  EXPECT_TRUE(
      parse_text(with_safety("chip = \"sim:0\"\nestop = [\"0\"]\n"))->safety->is_simulated());
  EXPECT_FALSE(
      parse_text(with_safety("chip = \"simatic\"\nestop = [\"0\"]\n"))->safety->is_simulated());
}

TEST(ConfigSafety, WithoutAnArmItHasNothingToKeepSafe) {
  EXPECT_THAT(
      mistakes("[safety]\nchip = \"c\"\nestop = [\"0\"]\n[[world]]\nname = \"w\"\nsource = "
               "\"box:3\"\n"),
      ElementsAre(AllOf(HasSubstr("t.toml:1:"), HasSubstr(" safety: "), HasSubstr("[[arm]]"))));
}

// The button and the deadman of a chip that is not there stop nothing.
class SafetyOfRealArm : public testing::Test {
 protected:
  static std::vector<std::string> mistakes_of(const std::string& chip, const std::string& device,
                                              const std::string& more = "") {
    std::string text = with_safety("chip = \"" + chip + "\"\nestop = [\"0\"]\n");
    const std::string simulated = "sim:phantom-vintage";
    text.replace(text.find(simulated), simulated.size(), device);
    text.insert(text.find("\n[[world]]"), more);
    return mistakes(text);
  }
};

TEST_F(SafetyOfRealArm, IsNeverSimulated) {
  for (const char* device : {"hid:A7", "usb:1-4", "serial:A7"}) {
    EXPECT_THAT(mistakes_of("sim:bench", device),
                ElementsAre(AllOf(
                    HasSubstr("t.toml:2:8: safety.chip: "), HasSubstr("arm 'right' is a real one"),
                    HasSubstr("as gpiodetect shows it in brackets"),
                    HasSubstr("docs/safety-wiring.md"), HasSubstr("found \"sim:bench\""))))
        << device;
    EXPECT_THAT(mistakes_of("cp2112_gpio", device), IsEmpty());
  }
  EXPECT_THAT(mistakes_of("sim:bench", "sim:phantom-vintage"), IsEmpty());
}

TEST_F(SafetyOfRealArm, IsNotSimulatedWhereASimulatedArmStandsInUntilItComes) {
  EXPECT_THAT(
      mistakes_of("sim:bench", "hid:A7", "model = \"polhem-1\"\nfallback = \"simulated\"\n"),
      ElementsAre(HasSubstr("safety.chip: ")));
}

TEST_F(SafetyOfRealArm, IsNotSimulatedWhereOneOfTwoArmsIsReal) {
  EXPECT_THAT(mistakes_of("sim:bench", "sim:phantom-vintage",
                          "[[arm]]\nname = \"left\"\ndevice = \"hid:A7\"\nworld = \"box\"\n"),
              ElementsAre(HasSubstr("arm 'left' is a real one")));
}

TEST_F(SafetyOfRealArm, IsNotSimulatedByAnOverrideEither) {
  EXPECT_THAT(
      mistakes(with_safety("chip = \"sim:bench\"\nestop = [\"0\"]\n"), {"arm.device=hid:A7"}),
      ElementsAre(HasSubstr("safety.chip: ")));
  EXPECT_THAT(mistakes(with_safety("chip = \"c\"\nestop = [\"0\"]\n"),
                       {"arm.device=hid:A7", "safety.chip=sim:bench"}),
              ElementsAre(HasSubstr("--set safety.chip: ")));
}

// A wrong device is one mistake, and nobody knows yet what it will be.
TEST_F(SafetyOfRealArm, IsNoQuestionWhereTheDeviceIsNone) {
  EXPECT_THAT(mistakes_of("sim:bench", "A7"), ElementsAre(HasSubstr("arm.0.device: ")));
}

TEST(ConfigSafety, OfASimulatedChipThereAreEightLines) {
  const std::string chip = "chip = \"sim:bench\"\n";
  EXPECT_THAT(mistakes(with_safety(chip + "estop = [\"0\", \"7\"]\nlamp = \"6\"\n")), IsEmpty());
  for (const char* line : {"8", "07", "-1", "GPIO17"}) {
    const std::string said = "\"" + std::string(line) + "\"";
    const auto refused = AllOf(HasSubstr("expected a line from \"0\" to \"7\""), HasSubstr(said));
    EXPECT_THAT(mistakes(with_safety(chip + "estop = [\"0\", " + said + "]\n")),
                ElementsAre(AllOf(HasSubstr("t.toml:3:"), HasSubstr("safety.estop: "), refused)));
    for (const std::string key : {"deadman", "enable", "lamp"}) {
      EXPECT_THAT(mistakes(with_safety(chip + "estop = [\"0\"]\n" + key + " = " + said + "\n")),
                  ElementsAre(AllOf(HasSubstr("safety." + key + ": "), refused)));
    }
  }
}

// A kernel may make a label of a path of the device tree.
TEST(ConfigSafety, AChipsLabelMayHaveSlashes) {
  EXPECT_THAT(mistakes(with_safety("chip = \"/soc/gpio@7e200000\"\nestop = [\"0\"]\n")), IsEmpty());
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
        BadSafety{"chip = \"/dev/gpiochip0\"\nestop = [\"0\"]\n",
                  "t.toml:2:", "safety.chip: ", "as gpiodetect shows it in brackets"},
        BadSafety{"chip = \"c\"\nestop = [\"abcdefghijklmnopqrstuvwxyz0123456789\"]\n",
                  "t.toml:3:", "safety.estop: ", "31 characters"}));

}  // namespace
}  // namespace thimble::config
