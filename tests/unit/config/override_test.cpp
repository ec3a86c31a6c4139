#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/config/config_testing.hpp"

namespace thimble::config {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Config with(std::string_view text, const std::vector<std::string>& overrides) {
  const auto result = parse_text(text, overrides);
  if (result) return *result;
  ADD_FAILURE() << to_string(result.error().front());
  return {{}, {}, {ArmConfig{}}, {WorldConfig{}}};
}

constexpr std::string_view kTwoArms = R"(
[[arm]]
name = "left"
device = "sim:a"
world = "box"
[[arm]]
name = "right"
device = "sim:b"
world = "box"
[[world]]
name = "box"
source = "box:3"
)";

TEST(ConfigOverride, ReplacesAValueAndMakesMissingTables) {
  EXPECT_EQ(with(kHello, {"servo.rate_hz=2000"}).servo.rate_hz, 2000);
  EXPECT_EQ(with(kHello, {"arm.0.device=sim:woody-2015"}).arms[0].device, "sim:woody-2015");
  EXPECT_EQ(with(kHello, {"arm.0.limits.force_newton=2"}).arms[0].limits.force_newton, 2.0);
}

TEST(ConfigOverride, FindsAnArmByIndexByNameOrBecauseItIsTheOnlyOne) {
  EXPECT_EQ(with(kTwoArms, {"arm.1.model=x"}).arms[1].model, "x");
  EXPECT_EQ(with(kTwoArms, {"arm.left.model=x"}).arms[0].model, "x");
  EXPECT_EQ(with(kHello, {"arm.model=x"}).arms[0].model, "x");
  EXPECT_EQ(with(kHello, {"world.source=box:9"}).worlds[0].source, "box:9");
}

TEST(ConfigOverride, ReadsTheValueAsTomlAndElseAsAString) {
  EXPECT_FALSE(with(kHello, {"arm.activate=false"}).arms[0].activate);
  EXPECT_EQ(with(kHello, {"arm.model=\"quoted\""}).arms[0].model, "quoted");
  EXPECT_EQ(with(kHello, {"arm.model=a=b c"}).arms[0].model, "a=b c");
  EXPECT_EQ(with(kHello, {"arm.hand={motion = \"poke\", seed = 4}"}).arms[0].hand,
            (HandConfig{HandMotion::Poke, 4, {}, {}, {}, {}, {}}));
}

TEST(ConfigOverride, LaterOnesWinAndCanBuildAWholeConfiguration) {
  const auto sut = with(
      "", {"arm.0.name=a", "arm.0.name=b", "arm.b.device=sim:x", "arm.b.world=w", "world.0.name=w",
           "world.w.source=box:3", "arm.1.name=c", "arm.c.device=sim:x", "arm.c.world=w"});
  ASSERT_EQ(sut.arms.size(), 2U);
  EXPECT_EQ(sut.arms[0].name, "b");
  EXPECT_EQ(sut.arms[1].name, "c");
}

TEST(ConfigOverride, CannotSmuggleInAnotherKey) {
  const auto sut = with(kHello, {"arm.model=1\nw = 2"});
  EXPECT_EQ(sut.arms[0].model, "1\nw = 2");
}

TEST(ConfigOverride, LeavesPathsToTheWorkingDirectory) {
  EXPECT_EQ(with(kHello, {"world.source=x.npy"}).worlds[0].source, "x.npy");
}

TEST(ConfigOverride, IsNamedByItsMistakesAfterThoseOfTheFile) {
  EXPECT_THAT(
      mistakes(hello_with_world("threshold = inf\n"),
               {"servo.rate_hz=1", "servo.rate=3", "arm.right.hand.motion=jump"}),
      ElementsAre(HasSubstr("t.toml:9:13: world.0.threshold"),
                  HasSubstr("--set servo.rate_hz: servo.rate_hz: expected a number from 500"),
                  HasSubstr("--set servo.rate: servo.rate: there is no such key; did you mean"),
                  HasSubstr("--set arm.right.hand.motion: arm.0.hand.motion: expected one of")));
}

TEST(ConfigOverride, BlamesItselfForATableItMade) {
  EXPECT_THAT(mistakes(kHello, {"world.1.name=w"}),
              ElementsAre(HasSubstr("--set world.1.name: world.1.source: expected")));
}

struct BadOverride {
  const char* text;
  const char* expected;
};

class ConfigBadOverride : public testing::TestWithParam<BadOverride> {};

TEST_P(ConfigBadOverride, IsRefusedAndTheRestIsStillChecked) {
  EXPECT_THAT(mistakes(kTwoArms, {GetParam().text}), ElementsAre(HasSubstr(GetParam().expected)));
}

INSTANTIATE_TEST_SUITE_P(
    Values, ConfigBadOverride,
    testing::Values(BadOverride{"servo.rate_hz", "--set servo.rate_hz: expected KEY=VALUE"},
                    BadOverride{"=3", "expected names between dots"},
                    BadOverride{"servo..rate_hz=3", "expected names between dots"},
                    BadOverride{"arm.model=x", "expected an index or one of \"left\", \"right\""},
                    BadOverride{"arm.midle.model=x",
                                "--set arm.midle.model: there is no arm \"midle\"; expected an "
                                "index or one of \"left\", \"right\""},
                    BadOverride{"arm.3.model=x", "there is no element 3, only 2"},
                    BadOverride{"arm.99999999999999999999999.model=x", "there is no arm \"9999"},
                    BadOverride{"world.bax.source=x",
                                "--set world.bax.source: there is no world \"bax\"; expected an "
                                "index or one of \"box\""},
                    BadOverride{"arm.0.name.x=1", "--set arm.0.name.x: \"name\" is not a table"},
                    BadOverride{"arm.0=3", "expected a key of this element"},
                    BadOverride{"arm.0.model=\xff", "expected a value in UTF-8"}));

// The file is not to blame for a name that an override made up.
TEST(ConfigOverride, OfAnArmThatIsNotThereSaysSoWhereThereIsOne) {
  EXPECT_THAT(
      mistakes(kHello, {"arm.left.limits.force_newton=2"}),
      ElementsAre("--set arm.left.limits.force_newton: there is no arm \"left\"; expected an "
                  "index or one of \"right\""));
  EXPECT_THAT(mistakes(kHello, {"arm.left.model=x"}), ElementsAre(HasSubstr("there is no arm")));
  EXPECT_EQ(with(kHello, {"arm.limits.force_newton=2"}).arms[0].limits.force_newton, 2.0);
  EXPECT_EQ(with(kHello, {"world.sphere.radius_m=0.01", "world.source=sphere"}).worlds[0].source,
            "sphere");
  EXPECT_THAT(mistakes(kHello, {"arm.device.x=1"}), ElementsAre(HasSubstr("is not a table")));
}

TEST(ConfigOverride, WithAnAbsurdlyLongKeyIsRefusedShortly) {
  const auto sut = mistakes(kHello, {std::string(100000, 'a') + "=1"});
  EXPECT_THAT(sut, ElementsAre(HasSubstr("expected a shorter key")));
  EXPECT_LT(sut[0].size(), 100U);
}

}  // namespace
}  // namespace thimble::config
