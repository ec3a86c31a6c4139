#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "tests/unit/config/config_testing.hpp"

namespace thimble::config {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

std::string field_of(const std::string& source, const std::string& lines,
                     const std::string& before = "") {
  return "[[world]]\nname = \"w\"\nsource = \"" + source + "\"\n" + before + "[world.field]\n" +
         lines;
}

TEST(ConfigField, ReadsEveryKey) {
  const auto sut = parse_text(
      field_of("a.npy",
               "unit_m = 0.001\ncenter_m = [0, -0.02, 0.01]\nstiffness_newton_per_m = 500\n"
               "damping_newton_s_per_m = 2\nfriction = 0.3\ntemperature_kelvin = 290\n",
               "cell_m = 0.002\naxis_order = \"zyx\"\n"));
  ASSERT_TRUE(sut);
  FieldConfig expected;
  expected.unit_m = 0.001;
  expected.center_m = {0, -0.02, 0.01};
  expected.stiffness_newton_per_m = 500;
  expected.damping_newton_s_per_m = 2;
  expected.friction = 0.3;
  expected.temperature_kelvin = 290;
  EXPECT_EQ(sut->worlds.at(0).field, expected);
  EXPECT_EQ(sut->worlds.at(0).axis_order, "zyx");
}

TEST(ConfigField, AnEmptyTableSaysThatNumbersAreDistances) {
  const auto sut = parse_text(field_of("a.nrrd", ""));
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->worlds.at(0).field, FieldConfig{});
  const auto without = parse_text("[[world]]\nname = \"w\"\nsource = \"a.nrrd\"\n");
  ASSERT_TRUE(without);
  EXPECT_FALSE(without->worlds.at(0).field);
}

TEST(ConfigField, AMeshIsAFieldWithoutATable) {
  for (const char* source : {"a.stl", "A.STL", "b.obj"}) {
    const auto sut =
        parse_text(std::string("[[world]]\nname = \"w\"\nsource = \"") + source + "\"\n");
    ASSERT_TRUE(sut);
    EXPECT_EQ(sut->worlds.at(0).source, std::string("/etc/thimble/") + source);
    ASSERT_TRUE(sut->worlds.at(0).field);
    EXPECT_TRUE(sut->worlds.at(0).field->is_mesh);
    EXPECT_EQ(sut->worlds.at(0).field->resolution, 64);
  }
  const auto sized = parse_text(field_of("a.stl", "longest_m = 0.05\nresolution = 32\n"));
  ASSERT_TRUE(sized);
  EXPECT_EQ(sized->worlds.at(0).field->longest_m, 0.05);
  EXPECT_EQ(sized->worlds.at(0).field->resolution, 32);
}

TEST(ConfigField, AMeshHasItsOwnKeysAndNoneOfAVolume) {
  EXPECT_THAT(mistakes(field_of("a.stl", "longest_m = 0.05\nunit_m = 1\n")),
              ElementsAre(HasSubstr("either longest_m or unit_m")));
  EXPECT_THAT(mistakes(field_of("a.stl", "resolution = 300\n")),
              ElementsAre(HasSubstr("8 to 256")));
  for (const char* line : {"longest_m = 0.05\n", "resolution = 32\n"}) {
    EXPECT_THAT(mistakes(field_of("a.npy", line)), ElementsAre(HasSubstr("only with a mesh")));
  }
  for (const char* line : {"threshold = 1\n", "workspace_m = 0.1\n", "cell_m = 0.001\n",
                           "spacing = [1, 1, 1]\n", "axis_order = \"zyx\"\n"}) {
    EXPECT_EQ(mistakes(field_of("a.stl", "", line)).size(), 1U) << line;
  }
}

TEST(ConfigField, GoesWithVolumeFilesAndHasNoCells) {
  for (const char* source : {"box:3", "sphere", "life"}) {
    EXPECT_THAT(mistakes(field_of(source, "")),
                ElementsAre(AllOf(HasSubstr("world.0.field"), HasSubstr(source))));
  }
  EXPECT_THAT(mistakes(field_of("a.npy", "", "threshold = 1\n")),
              ElementsAre(AllOf(HasSubstr("threshold"), HasSubstr("[world.field]"))));
  EXPECT_THAT(mistakes(field_of("a.npy",
                                "[[world.material]]\nname = \"m\"\nfrom = 1\n"
                                "friction = 0.1\n")),
              ElementsAre(AllOf(HasSubstr("material"), HasSubstr("[world.field]"))));
  EXPECT_THAT(mistakes(field_of("a.npy", "unit_m = 0\n")), ElementsAre(HasSubstr("unit_m")));
}

}  // namespace
}  // namespace thimble::config
