#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "tests/unit/config/config_testing.hpp"

namespace thimble::config {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string volume_with(const std::string& lines) {
  return "[[world]]\nname = \"scan\"\nsource = \"scan.nrrd\"\n" + lines;
}

TEST(ConfigVolume, KnowsTheEndingsOfVolumeFiles) {
  for (const char* ending : {"npy", "nrrd", "nhdr"}) {
    const auto sut =
        parse_text(std::string("[[world]]\nname = \"w\"\nsource = \"a.") + ending + "\"\n");
    ASSERT_TRUE(sut) << ending;
    EXPECT_EQ(sut->worlds.at(0).source, std::string("/etc/thimble/a.") + ending);
  }
  EXPECT_THAT(mistakes("[[world]]\nname = \"w\"\nsource = \"a.mha\"\n"),
              ElementsAre(HasSubstr(".npy, .nrrd, .nhdr, .stl or .obj file, found \"a.mha\"")));
}

TEST(ConfigVolume, SaysNothingThatTheFileDoesNotSay) {
  const auto sut = parse_text(volume_with(""));
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->worlds.at(0).axis_order, "xyz");
  EXPECT_FALSE(sut->worlds.at(0).spacing);
  EXPECT_FALSE(sut->worlds.at(0).cell_m);
}

TEST(ConfigVolume, ReadsEveryKey) {
  const auto sut = parse_text(volume_with(
      "cell_m = 0.0005\nthreshold = -400.5\naxis_order = \"zyx\"\nspacing = [2, 1, 0.5]\n"));
  ASSERT_TRUE(sut);
  WorldConfig expected;
  expected.name = "scan";
  expected.source = "/etc/thimble/scan.nrrd";
  expected.threshold = -400.5;
  expected.cell_m = 0.0005;
  expected.axis_order = "zyx";
  expected.spacing = std::array{2.0, 1.0, 0.5};
  EXPECT_THAT(sut->worlds, ElementsAre(expected));
}

TEST(ConfigVolume, TakesEveryOrderOfTheAxes) {
  for (const char* order : {"xyz", "xzy", "yxz", "yzx", "zxy", "zyx", "-xyz", "z-y-x"}) {
    const auto sut = parse_text(volume_with(std::string("axis_order = \"") + order + "\"\n"));
    ASSERT_TRUE(sut);
    EXPECT_EQ(sut->worlds.at(0).axis_order, order);
  }
  for (const char* order : {"xy", "xyy", "XYZ", "xyzx", "x y", "xyz-", "--xyz", "-"}) {
    EXPECT_THAT(mistakes(volume_with(std::string("axis_order = \"") + order + "\"\n")),
                ElementsAre(HasSubstr("in any order, each with or without a - before it, found")))
        << order;
  }
}

TEST(ConfigVolume, TellsEachMistakeOnce) {
  for (const auto& [line, said] :
       {std::pair{"cell_m = 0.001\nworkspace_m = 0.1\n", "either cell_m or workspace_m"},
        std::pair{"cell_m = 0\n", "above 0 up to 1, found 0"},
        std::pair{"spacing = [1, 1]\n", "3 numbers, each above 0 up to 1e+06, found an array"},
        std::pair{"spacing = [1, 0, 1]\n", "found 0"}, std::pair{"spacing = [1, nan, 1]\n", "nan"},
        std::pair{"spacing = [1, \"a\", 1]\n", "found \"a\""},
        std::pair{"spacing = 1\n", "found 1"}}) {
    EXPECT_THAT(mistakes(volume_with(line)), ElementsAre(HasSubstr(said))) << line;
    EXPECT_THAT(mistakes(hello_with_world(line)), ElementsAre(HasSubstr(said))) << line;
  }
}

TEST(ConfigVolume, ReadsItsMaterials) {
  const auto sut = parse_text(volume_with(
      "[[world.material]]\nname = \"bone\"\nfrom = 300\nto = 3000\nstiffness_newton_per_m = 1500\n"
      "[[world.material]]\nname = \"label\"\nfrom = 2\ndamping_newton_s_per_m = 8\n"
      "friction = 0.4\n"));
  ASSERT_TRUE(sut);
  EXPECT_THAT(sut->worlds.at(0).materials,
              ElementsAre(MaterialConfig{"bone", 300, 3000, 1500, std::nullopt},
                          MaterialConfig{"label", 2, 2, std::nullopt, 8, 0.4}));
}

TEST(ConfigVolume, RefusesMaterialsThatAreNone) {
  for (const auto& [lines, said] :
       {std::pair{"from = 1\nfriction = 0\n", "world.0.material.0.name: expected a name"},
        std::pair{"name = \"a\"\nfriction = 0\n",
                  "world.0.material.0.from: expected a number of the file"},
        std::pair{"name = \"a\"\nfrom = 2\nto = 1\nfriction = 0\n", "not below from, found 1"},
        std::pair{"name = \"a\"\nfrom = 2\nstiffness_newton_per_m = 0\n", "above 0 up to 20000"},
        std::pair{"name = \"a\"\nfrom = 2\nfriction = 1.1\n", "from 0 to 1, found 1.1"},
        std::pair{"name = \"a\"\nfrom = 2\nfriction = 0\nfrictoin = 0\n",
                  "there is no such key"}}) {
    EXPECT_THAT(mistakes(volume_with(std::string("[[world.material]]\n") + lines)),
                ElementsAre(HasSubstr(said)))
        << lines;
  }
  std::string many;
  for (int i = 0; i < 16; ++i) {
    many += "[[world.material]]\nname = \"a\"\nfrom = 1\nfriction = 0\n";
  }
  EXPECT_THAT(mistakes(volume_with(many)),
              ElementsAre(HasSubstr("at most 15 materials, found 16")));
  EXPECT_THAT(
      mistakes(hello_with_world("[[world.material]]\nname = \"a\"\nfrom = 1\nfriction = 0\n")),
      ElementsAre(HasSubstr("only with a volume file")));
}

TEST(ConfigVolume, RefusesMaterialsThatWouldNeverBeFelt) {
  const std::string bone = "[[world.material]]\nname = \"bone\"\n";
  EXPECT_THAT(
      mistakes(volume_with("threshold = 3\n" + bone + "from = 2\nfriction = 0\n")),
      ElementsAre(HasSubstr("material.0.from: expected a number above world.threshold, 3")));
  EXPECT_THAT(mistakes(volume_with("threshold = 3\n" + bone + "from = 2\nto = 3\nfriction = 0\n")),
              ElementsAre(HasSubstr("material.0.to: expected a number above world.threshold, 3")));
  EXPECT_TRUE(
      mistakes(volume_with("threshold = 3\n" + bone + "from = 2\nto = 4\nfriction = 0\n")).empty());
  EXPECT_THAT(mistakes(volume_with(bone + "from = 2\n")),
              ElementsAre(HasSubstr("temperature_kelvin beside it, found none")));
  EXPECT_THAT(
      mistakes(volume_with("constraint_model = \"simple\"\n" + bone + "from = 2\nfriction = 0\n")),
      ElementsAre(HasSubstr("the simple model tells no surface")));
}

TEST(ConfigVolume, ABoxTakesNoneOfItsKeys) {
  for (const char* line :
       {"cell_m = 0.001\n", "axis_order = \"zyx\"\n", "spacing = [1, 2, 1.5]\n"}) {
    EXPECT_TRUE(mistakes(volume_with(line)).empty()) << line;
    EXPECT_THAT(mistakes(hello_with_world(line)),
                ElementsAre(HasSubstr("only with a volume file, found beside \"box:3\"")))
        << line;
  }
}

}  // namespace
}  // namespace thimble::config
