#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "daemon/session/inspect.hpp"
#include "daemon/session/plugins.hpp"

namespace thimble::session {

inline config::Config with_sphere() {
  config::Config config;
  config::WorldConfig world;
  world.name = "hello";
  world.source = "sphere";
  world.sphere.emplace();
  config.worlds.push_back(world);
  return config;
}

inline config::Config with_falcon() {
  config::Config config = with_sphere();
  config::ArmConfig arm;
  arm.name = "right";
  arm.device = "sim:falcon";
  arm.world = "hello";
  arm.hand.emplace();
  config.arms.push_back(arm);
  return config;
}

class InspectRealArm : public ::testing::Test {
 protected:
  InspectRealArm() {
    arm().device = "hid:NOBODY";
    arm().hand.reset();
  }
  config::ArmConfig& arm() { return config.arms[0]; }
  // "KEY: MESSAGE" of each, of an arm that is not there.
  [[nodiscard]] std::vector<std::string> objections() const {
    std::vector<std::string> all;
    for (const config::Objection& one : inspect(config, {plugins.models, plugins.drivers})) {
      all.push_back(one.key + ": " + one.message);
    }
    return all;
  }
  Plugins plugins;
  config::Config config{with_falcon()};
};

}  // namespace thimble::session
