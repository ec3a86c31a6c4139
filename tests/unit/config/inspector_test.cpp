#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/config/config_testing.hpp"

namespace thimble::config {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> mistakes_with(const std::string& text, const Inspector& inspect,
                                       const std::vector<std::string>& overrides = {}) {
  std::vector<std::string> out;
  const ConfigResult result = parse(text, "/etc/thimble/t.toml", overrides, inspect);
  if (result) return out;
  for (const ConfigError& error : result.error()) out.push_back(to_string(error));
  return out;
}

Objection to_arm(std::string key, std::string message) {
  return {Objection::Table::Arm, 0, std::move(key), std::move(message)};
}

TEST(ConfigInspector, ItsObjectionsStandAmongTheMistakesWithTheirPlaces) {
  const auto inspect = [](const Config&) {
    return std::vector<Objection>{{Objection::Table::World, 0, "source", "no such file"},
                                  to_arm("device", "no such arm"),
                                  to_arm("model", "not said"),
                                  to_arm("", "cannot be")};
  };
  EXPECT_THAT(mistakes_with(hello_with_arm("speed = 1\n"), inspect),
              ElementsAre("/etc/thimble/t.toml:1:1: arm.0.model: not said",
                          "/etc/thimble/t.toml:1:1: arm.0: cannot be",
                          "/etc/thimble/t.toml:3:10: arm.0.device: no such arm",
                          HasSubstr("t.toml:5:1: arm.0.speed: there is no such key"),
                          "/etc/thimble/t.toml:9:10: world.0.source: no such file"));
  EXPECT_THAT(mistakes_with(std::string(kHello), inspect, {"world.source=box:4"}).back(),
              "--set world.source: world.0.source: no such file");
}

TEST(ConfigInspector, ObjectsToTheDaemonsTableToo) {
  const auto inspect = [](const Config& config) {
    EXPECT_EQ(config.daemon.plugins, std::vector<std::string>{"/a.so"});
    return std::vector<Objection>{{Objection::Table::Daemon, 0, "plugins", "no such file"}};
  };
  EXPECT_THAT(mistakes_with("[daemon]\nplugins = ['/a.so']\n" + std::string(kHello), inspect),
              ElementsAre("/etc/thimble/t.toml:2:11: daemon.plugins: no such file"));
}

TEST(ConfigInspector, SeesNoValueThatTheSchemaRefusedAndRepeatsNoComplaint) {
  std::string text = hello_with_arm("amplifier_max_a = -1\n");
  text.replace(text.find("sim:phantom"), 4, "sum:");
  text.replace(text.find("box:3"), 5, "box:2");
  const auto inspect = [](const Config& config) {
    EXPECT_EQ(config.arms.at(0).device, "");
    EXPECT_EQ(config.arms.at(0).amplifier_max_a, std::nullopt);
    EXPECT_EQ(config.worlds.at(0).source, "");
    return std::vector<Objection>{to_arm("amplifier_max_a", "is missing")};
  };
  EXPECT_THAT(mistakes_with(text, inspect),
              ElementsAre(HasSubstr("arm.0.device: expected sim:MODEL"),
                          HasSubstr("amplifier_max_a: expected a number above 0"),
                          HasSubstr("world.0.source: expected \"box:N\"")));
}

TEST(ConfigInspector, WithoutObjectionsTheConfigurationIsGood) {
  int asked = 0;
  const auto result = parse(kHello, "t.toml", {}, [&](const Config& config) {
    ++asked;
    EXPECT_EQ(config.arms.size(), 1U);
    return std::vector<Objection>{};
  });
  EXPECT_TRUE(result);
  EXPECT_EQ(asked, 1);
}

}  // namespace
}  // namespace thimble::config
