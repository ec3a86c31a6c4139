#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "daemon/config/schema.hpp"
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

TEST(ConfigCoupling, WhatFeelsNoMaterialsRefusesAWorldWithSome) {
  const std::string arms =
      "[[arm]]\nname = \"left\"\ndevice = \"sim:phantom-vintage\"\nworld = \"scan\"\n"
      "[[arm]]\nname = \"right\"\ndevice = \"sim:phantom-vintage\"\nworld = \"scan\"\n";
  const std::string scan = "[[world]]\nname = \"scan\"\nsource = \"scan.nrrd\"\n";
  const std::string bone = "[[world.material]]\nname = \"bone\"\nfrom = 2\nfriction = 0.1\n";
  EXPECT_THAT(mistakes(arms + scan + bone), IsEmpty());
  for (const std::string scheme : {"thesis-literal", "buffer-zone", "composite"}) {
    const std::string line = "coupling.scheme = \"" + scheme + "\"\n";
    EXPECT_THAT(mistakes(arms + line + scan), IsEmpty());
    EXPECT_THAT(
        mistakes(arms + line + scan + bone),
        ElementsAre(AllOf(HasSubstr("arm.1.coupling: \"" + scheme + "\" feels no materials"),
                          HasSubstr("world \"scan\" has some"))));
  }
}

TEST(ConfigCoupling, ASchemeIsChosenByOneLine) {
  const std::vector<std::pair<std::string, CouplingScheme>> all{
      {"ghost-point", CouplingScheme::GhostPoint},
      {"thesis-literal", CouplingScheme::ThesisLiteral},
      {"remote-force", CouplingScheme::RemoteForce},
      {"spring-damper", CouplingScheme::SpringDamper},
      {"wave", CouplingScheme::Wave},
      {"constraint-plane", CouplingScheme::ConstraintPlane},
      {"buffer-zone", CouplingScheme::BufferZone},
      {"composite", CouplingScheme::Composite},
      {"auto", CouplingScheme::Auto}};
  for (const auto& [word, scheme] : all) {
    const auto sut = parse_text(hello_with_arm("coupling.scheme = \"" + word + "\"\n"));
    ASSERT_TRUE(sut) << word;
    EXPECT_EQ(sut->arms[0].coupling.scheme, scheme);
    EXPECT_EQ(to_string(scheme), word);
  }
  EXPECT_THAT(mistakes(hello_with_arm("coupling.scheme = \"waves\"\n")),
              ElementsAre(AllOf(HasSubstr("ghost-point"), HasSubstr("thesis-literal"),
                                HasSubstr("remote-force"), HasSubstr("spring-damper"),
                                HasSubstr("wave"), HasSubstr("constraint-plane"),
                                HasSubstr("buffer-zone"), HasSubstr("composite"))));
}

TEST(ConfigCoupling, EachSchemeTakesItsOwnNumbersAndNoOthers) {
  const std::vector<std::pair<std::string, std::string>> taken{
      {"stiffness_newton_per_m = 100",
       "auto ghost-point composite remote-force spring-damper constraint-plane buffer-zone"},
      {"damping_newton_s_per_m = 3",
       "auto ghost-point composite remote-force spring-damper constraint-plane buffer-zone"},
      {"buffer_m = 0.01", "buffer-zone"},
      {"zone = \"faces\"", "buffer-zone"},
      {"impedance_newton_s_per_m = 20", "wave"},
      {"force_at = \"both\"", "spring-damper"},
      {"master_mass_kg = 0.1", "spring-damper"},
      {"hysteresis_m = 0.001", "auto ghost-point composite constraint-plane"},
      {"late_walls = \"offset\"", "constraint-plane"},
      {"coordinate_spring_newton_per_m = 10", "auto ghost-point composite"},
      {"relaxation_m_per_s = 0.01", "auto ghost-point composite constraint-plane"}};
  for (const char* scheme : {"auto", "ghost-point", "composite", "remote-force", "spring-damper",
                             "wave", "constraint-plane", "buffer-zone"}) {
    const std::string line = std::string("coupling.scheme = \"") + scheme + "\"\n";
    for (const auto& [key, takers] : taken) {
      const auto found = mistakes(hello_with_arm(line + "coupling." + key + "\n"));
      if (takers.find(scheme) != std::string::npos) {
        EXPECT_THAT(found, IsEmpty()) << scheme << ", " << key;
      } else {
        EXPECT_THAT(found, ElementsAre(AllOf(HasSubstr("expected only with scheme"),
                                             HasSubstr(std::string("found beside \"") + scheme))));
      }
    }
  }
}

TEST(ConfigCoupling, LateWallsTakeTheTimeOfTheirKind) {
  const std::string scheme = "coupling.scheme = \"constraint-plane\"\n";
  const std::string recovery = "coupling.late_walls = \"recovery\"\n";
  const std::string time = "coupling.recovery_s = 0.2\n";
  const std::string speed = "coupling.relaxation_m_per_s = 0.01\n";
  const auto sut = parse_text(hello_with_arm(scheme + recovery + time));
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->arms[0].coupling.late_walls, CouplingLateWalls::Recovery);
  EXPECT_EQ(sut->arms[0].coupling.recovery_s, 0.2);
  EXPECT_THAT(mistakes(hello_with_arm(scheme + speed)), IsEmpty());
  EXPECT_THAT(mistakes(hello_with_arm(scheme + time)),
              ElementsAre(AllOf(HasSubstr("arm.0.coupling.recovery_s"),
                                HasSubstr("expected only with late_walls = \"recovery\""))));
  EXPECT_THAT(mistakes(hello_with_arm(scheme + recovery + speed)),
              ElementsAre(AllOf(HasSubstr("arm.0.coupling.relaxation_m_per_s"),
                                HasSubstr("expected only with late_walls = \"offset\""))));
  EXPECT_EQ(mistakes(hello_with_arm(scheme + recovery + "coupling.recovery_s = 0\n")).size(), 1U);
}

TEST(ConfigCoupling, AnySchemeIsGuardedByOneLine) {
  for (const char* scheme : {"ghost-point", "thesis-literal", "remote-force", "spring-damper",
                             "wave", "constraint-plane", "buffer-zone", "composite"}) {
    const std::string lines =
        std::string("coupling.scheme = \"") + scheme + "\"\ncoupling.passivity = true\n";
    const auto sut = parse_text(hello_with_arm(lines));
    ASSERT_TRUE(sut) << scheme;
    EXPECT_EQ(sut->arms[0].coupling.passivity, PassivityConfig{});
  }
  EXPECT_FALSE(
      parse_text(hello_with_arm("coupling.passivity = false\n"))->arms[0].coupling.passivity);
}

TEST(ConfigCoupling, AGuardBetweenBothEndsGoesWithForcesThatTheWorldTells) {
  const std::string two = "coupling.passivity = \"two-port\"\n";
  for (const char* scheme : {"remote-force", "spring-damper"}) {
    const std::string lines = std::string("coupling.scheme = \"") + scheme + "\"\n";
    const auto sut =
        parse_text(hello_with_arm(lines + two + "coupling.passivity_bound_joule = 0.01\n"));
    ASSERT_TRUE(sut) << scheme;
    PassivityConfig expected;
    expected.bound_joule = 0.01;
    expected.is_two_port = true;
    EXPECT_EQ(sut->arms[0].coupling.passivity, expected);
  }
  for (const char* scheme : {"ghost-point", "thesis-literal", "constraint-plane", "buffer-zone",
                             "composite", "spring-damper\"\ncoupling.force_at = \"both"}) {
    EXPECT_THAT(
        mistakes(hello_with_arm(std::string("coupling.scheme = \"") + scheme + "\"\n" + two)),
        ElementsAre(AllOf(HasSubstr("arm.0.coupling.passivity"),
                          HasSubstr("where no force is told by the world"))))
        << scheme;
  }
  EXPECT_THAT(mistakes(hello_with_arm("coupling.scheme = \"wave\"\n" + two)),
              ElementsAre(HasSubstr("guarded between both ends already")));
  const std::string remote = "coupling.scheme = \"remote-force\"\n";
  EXPECT_THAT(
      mistakes(hello_with_arm(remote + two + "coupling.passivity_damping_newton_s_per_m = 3\n")),
      ElementsAre(HasSubstr("withholds and has no cap")));
  EXPECT_THAT(mistakes(hello_with_arm(remote + "coupling.passivity = \"both\"\n")),
              ElementsAre(HasSubstr("expected \"two-port\"")));
}

TEST(ConfigCoupling, TheGuardsNumbersAreTakenBesideItOnly) {
  const std::vector<std::string> keys{"passivity_bound_joule = 0.01",
                                      "passivity_damping_newton_s_per_m = 3",
                                      "passivity_least_m_per_s = 0.02"};
  std::string all = "coupling.passivity = true\n";
  for (const std::string& key : keys) {
    EXPECT_THAT(mistakes(hello_with_arm("coupling." + key + "\n")),
                ElementsAre(AllOf(HasSubstr("arm.0.coupling." + key.substr(0, key.find(' '))),
                                  HasSubstr("expected only beside passivity = true"))));
    all += "coupling." + key + "\n";
  }
  const auto sut = parse_text(hello_with_arm(all));
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->arms[0].coupling.passivity, (PassivityConfig{0.01, 3, 0.02, false}));
  EXPECT_EQ(mistakes(hello_with_arm("coupling.passivity = true\n"
                                    "coupling.passivity_damping_newton_s_per_m = 0\n"))
                .size(),
            1U);
}

TEST(ConfigCoupling, NumbersOfAFarEndStayBelowItsCeilings) {
  for (const char* lines :
       {"coupling.scheme = \"remote-force\"\ncoupling.stiffness_newton_per_m = 3001\n",
        "coupling.scheme = \"remote-force\"\ncoupling.damping_newton_s_per_m = 21\n",
        "coupling.scheme = \"spring-damper\"\ncoupling.damping_newton_s_per_m = 0\n",
        "coupling.scheme = \"spring-damper\"\ncoupling.master_mass_kg = 0\n",
        "coupling.scheme = \"spring-damper\"\ncoupling.master_mass_kg = 2.1\n",
        "coupling.scheme = \"wave\"\ncoupling.impedance_newton_s_per_m = 41\n"}) {
    EXPECT_EQ(mistakes(hello_with_arm(lines)).size(), 1U) << lines;
  }
}

TEST(ConfigCoupling, ASlaveZoneOrMapIsRefusedInLockStep) {
  const std::string mode = "coupling.mode = \"lock-step\"\n";
  for (const char* scheme : {"spring-damper", "wave", "buffer-zone", "composite"}) {
    const std::string line = std::string("coupling.scheme = \"") + scheme + "\"\n";
    EXPECT_THAT(
        mistakes(hello_with_arm(line + mode)),
        ElementsAre(AllOf(HasSubstr("arm.0.coupling.mode"), HasSubstr("follows a stream"))));
  }
  for (const char* scheme : {"auto", "remote-force"}) {
    const std::string line = std::string("coupling.scheme = \"") + scheme + "\"\n";
    EXPECT_THAT(mistakes(hello_with_arm(line + mode)), IsEmpty());
  }
}

TEST(ConfigCoupling, AFarEndOrAZoneIsRefusedOverTheDatagramsOf1999) {
  for (const char* scheme : {"remote-force", "spring-damper", "wave", "buffer-zone", "composite"}) {
    const std::string arm = std::string("[[arm]]\nname = \"left\"\ndevice = ") +
                            "\"sim:phantom-vintage\"\nlink = \"udp://127.0.0.1:5001\"\n" +
                            "coupling.scheme = \"" + scheme + "\"\n";
    EXPECT_THAT(mistakes(arm),
                ElementsAre(AllOf(HasSubstr(std::string("arm.0.coupling: \"") + scheme),
                                  HasSubstr("datagrams of 1999 do not carry"))));
    EXPECT_THAT(mistakes(arm + "protocol = \"thimble\"\n"), IsEmpty()) << scheme;
  }
}

TEST(ConfigCoupling, AFarEndOrAZoneIsRefusedInAWorldOfTheSimpleModel) {
  for (const char* scheme : {"remote-force", "spring-damper", "wave", "buffer-zone", "composite"}) {
    const std::string line = std::string("coupling.scheme = \"") + scheme + "\"\n";
    EXPECT_THAT(mistakes(hello_with_arm(line) + "constraint_model = \"simple\"\n"),
                ElementsAre(AllOf(HasSubstr(std::string("arm.0.coupling: \"") + scheme),
                                  HasSubstr("constraint_model = \"simple\""))));
  }
}

TEST(ConfigCoupling, AnUnknownConstraintModelIsNamedWithThoseThereAre) {
  EXPECT_THAT(mistakes(hello_with_world("constraint_model = \"naive\"\n")),
              ElementsAre(AllOf(HasSubstr("world.0.constraint_model"), HasSubstr("ghost-point"),
                                HasSubstr("simple"), HasSubstr("naive"))));
}

}  // namespace
}  // namespace thimble::config
