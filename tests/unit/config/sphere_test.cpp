#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/unit/config/config_testing.hpp"

namespace thimble::config {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

std::string sphere_with(const std::string& lines) {
  return "[[world]]\nname = \"w\"\nsource = \"sphere\"\n" + lines;
}

TEST(ConfigSphere, NeedsNothingButItsName) {
  const auto sut = parse_text(sphere_with(""));
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->worlds.at(0).source, "sphere");
  EXPECT_EQ(sut->worlds.at(0).sphere, SphereConfig{});
}

TEST(ConfigSphere, RestsOnItsFloorBelowTheOrigin) {
  const SphereConfig sut;
  EXPECT_DOUBLE_EQ(sut.center_m[1] - sut.radius_m, sut.floor_m);
  EXPECT_LT(sut.center_m[1] + sut.radius_m, 0);
}

TEST(ConfigSphere, ReadsEveryKey) {
  const auto sut = parse_text(
      sphere_with("[world.sphere]\nradius_m = 0.03\ncenter_m = [0.01, -0.02, 0.005]\nfloor_m = "
                  "-0.04\nstiffness_newton_per_m = 600\ndamping_newton_s_per_m = 3\n"
                  "friction = 0.2\n"));
  ASSERT_TRUE(sut);
  const SphereConfig expected{0.03, {0.01, -0.02, 0.005}, -0.04, 600, 3, 0.2};
  EXPECT_EQ(sut->worlds.at(0).sphere, expected);
}

TEST(ConfigSphere, ItsTableBesideAnotherSourceIsAMistake) {
  EXPECT_THAT(mistakes("[[world]]\nname = \"w\"\nsource = \"box:3\"\n[world.sphere]\n"),
              ElementsAre(AllOf(HasSubstr("world.0.sphere"), HasSubstr("\"box:3\""))));
  EXPECT_FALSE(parse_text("[[world]]\nname = \"w\"\nsource = \"box:3\"\n")->worlds[0].sphere);
}

struct BadSphere {
  const char* lines;
  const char* expected;
};
class ConfigSphereBadLine : public testing::TestWithParam<BadSphere> {};

TEST_P(ConfigSphereBadLine, IsTheOnlyMistakeReported) {
  EXPECT_THAT(mistakes(sphere_with(GetParam().lines)), ElementsAre(HasSubstr(GetParam().expected)));
}

INSTANTIATE_TEST_SUITE_P(
    Values, ConfigSphereBadLine,
    testing::Values(BadSphere{"sphere.radius_m = 0\n", "0.001 to 1, found 0"},
                    BadSphere{"sphere.radius_m = nan\n", "found nan"},
                    BadSphere{"sphere.center_m = [0, 0]\n", "sphere.center_m"},
                    BadSphere{"sphere.center_m = [0, 0, 2]\n", "sphere.center_m"},
                    BadSphere{"sphere.floor_m = -0.005\n", "below the top of the sphere"},
                    BadSphere{"sphere.floor_m = \"low\"\n", "found \"low\""},
                    BadSphere{"sphere.friction = 2\n", "from 0 to 1"},
                    BadSphere{"sphere.radios_m = 1\n", "did you mean \"radius_m\"?"},
                    BadSphere{"sphere = 3\n", "world.0.sphere: expected a table, found 3"},
                    BadSphere{"workspace_m = 0.1\n", "only with a world of cells"},
                    BadSphere{"threshold = 1\n", "only with a world of cells"},
                    BadSphere{"cell_m = 0.001\n",
                              "only with a volume file, found beside \"sphere\""}));

}  // namespace
}  // namespace thimble::config
