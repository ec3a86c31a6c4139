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

TEST(ConfigCoupling, ThePrintedCallbackTakesNoNumbersOfOnesOwn) {
  const std::string scheme = "coupling.scheme = \"thesis-literal\"\n";
  const auto sut = parse_text(hello_with_arm(scheme + "coupling.fade_after_s = 1\n"));
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->arms[0].coupling.scheme, CouplingScheme::ThesisLiteral);
  for (const char* key : {"stiffness_newton_per_m", "damping_newton_s_per_m",
                          "coordinate_spring_newton_per_m", "hysteresis_m", "relaxation_m_per_s"}) {
    const std::string line = std::string("coupling.") + key + " = 0.01\n";
    EXPECT_THAT(mistakes(hello_with_arm(line)), IsEmpty());
    EXPECT_THAT(mistakes(hello_with_arm(scheme + line)),
                ElementsAre(AllOf(HasSubstr(std::string("arm.0.coupling.") + key),
                                  HasSubstr("thesis-literal\" has its numbers printed"))));
  }
}

TEST(ConfigCoupling, ThePrintedCallbackRefusesAWorldWithMaterials) {
  const std::string arms =
      "[[arm]]\nname = \"left\"\ndevice = \"sim:phantom-vintage\"\nworld = \"scan\"\n"
      "[[arm]]\nname = \"right\"\ndevice = \"sim:phantom-vintage\"\nworld = \"scan\"\n";
  const std::string scheme = "coupling.scheme = \"thesis-literal\"\n";
  const std::string scan = "[[world]]\nname = \"scan\"\nsource = \"scan.nrrd\"\n";
  const std::string bone = "[[world.material]]\nname = \"bone\"\nfrom = 2\nfriction = 0.1\n";
  EXPECT_THAT(mistakes(arms + scan + bone), IsEmpty());
  EXPECT_THAT(mistakes(arms + scheme + scan), IsEmpty());
  EXPECT_THAT(mistakes(arms + scheme + scan + bone),
              ElementsAre(AllOf(HasSubstr("arm.1.coupling: \"thesis-literal\" feels no materials"),
                                HasSubstr("world \"scan\" has some"))));
}

TEST(ConfigCoupling, AnUnknownConstraintModelIsNamedWithThoseThereAre) {
  EXPECT_THAT(mistakes(hello_with_world("constraint_model = \"naive\"\n")),
              ElementsAre(AllOf(HasSubstr("world.0.constraint_model"), HasSubstr("ghost-point"),
                                HasSubstr("simple"), HasSubstr("naive"))));
}

}  // namespace
}  // namespace thimble::config
