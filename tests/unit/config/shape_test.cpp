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

std::string shapes_with(const std::string& lines) {
  return "[[world]]\nname = \"w\"\nsource = \"shapes\"\n" + lines;
}
const std::string kShape = "[[world.shape]]\n";
const std::string kBall = kShape + "kind = \"sphere\"\nradius_m = 0.02\n";

TEST(ConfigShapes, ReadsEveryKindAndKey) {
  const auto sut = parse_text(
      shapes_with(kBall + "center_m = [0.01, -0.02, 0.03]\nrotation_rad = [0, 1.5, 0]\n" +
                  "stiffness_newton_per_m = 600\ndamping_newton_s_per_m = 3\nfriction = 0.2\n" +
                  kShape + "kind = \"box\"\nsize_m = [0.01, 0.02, 0.03]\n" + kShape +
                  "kind = \"capsule\"\nradius_m = 0.01\nlength_m = 0.03\n" + kShape +
                  "kind = \"cylinder\"\nradius_m = 0.01\nlength_m = 0.03\n" + kShape +
                  "kind = \"floor\"\ncenter_m = [0, -0.04, 0]\n"));
  ASSERT_TRUE(sut);
  const auto& shapes = sut->worlds.at(0).shapes;
  ASSERT_EQ(shapes.size(), 5U);
  const ShapeConfig ball{
      ShapeKind::Sphere, {0.01, -0.02, 0.03}, {0, 1.5, 0}, 0.02, 0, {}, 600, 3, 0.2};
  EXPECT_EQ(shapes[0], ball);
  EXPECT_EQ(shapes[1].size_m, (std::array<double, 3>{0.01, 0.02, 0.03}));
  EXPECT_EQ(shapes[2].kind, ShapeKind::Capsule);
  EXPECT_EQ(shapes[3].length_m, 0.03);
  EXPECT_EQ(shapes[4].kind, ShapeKind::Floor);
}

TEST(ConfigShapes, AreNeededBesideTheirSourceAndRefusedBesideOthers) {
  EXPECT_THAT(mistakes(shapes_with("")), ElementsAre(HasSubstr("at least one [[world.shape]]")));
  EXPECT_THAT(mistakes("[[world]]\nname = \"w\"\nsource = \"box:3\"\n" + kBall),
              ElementsAre(AllOf(HasSubstr("world.0.shape"), HasSubstr("\"box:3\""))));
  std::string many;
  for (int i = 0; i < 33; ++i) many += kBall;
  EXPECT_THAT(mistakes(shapes_with(many)), ElementsAre(HasSubstr("at most 32 shapes, found 33")));
}

TEST(ConfigShapes, EachKindNeedsItsSizesAndTakesNoOthers) {
  const auto with = [](const std::string& kind, const std::string& lines) {
    return mistakes(shapes_with(kShape + "kind = \"" + kind + "\"\n" + lines));
  };
  EXPECT_THAT(with("sphere", ""), ElementsAre(HasSubstr("radius_m")));
  EXPECT_THAT(with("box", ""), ElementsAre(HasSubstr("size_m")));
  EXPECT_THAT(with("cylinder", "radius_m = 0.01\n"), ElementsAre(HasSubstr("length_m")));
  EXPECT_THAT(with("floor", ""), IsEmpty());
  EXPECT_THAT(with("floor", "radius_m = 0.01\n"),
              ElementsAre(HasSubstr("expected only with a kind of shape that has it")));
  EXPECT_THAT(with("sphere", "radius_m = 0.0001\n"), ElementsAre(HasSubstr("0.001 to 1")));
  EXPECT_THAT(with("cube", ""), ElementsAre(HasSubstr("\"cylinder\"")));
}

TEST(ConfigShapes, HaveNoCells) {
  EXPECT_THAT(mistakes(shapes_with("workspace_m = 0.1\n" + kBall)),
              ElementsAre(AllOf(HasSubstr("workspace_m"), HasSubstr("a world of cells"))));
}

}  // namespace
}  // namespace thimble::config
