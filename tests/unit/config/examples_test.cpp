#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "daemon/config/load.hpp"

namespace thimble::config {
namespace {

TEST(Examples, LoadWithoutAMistake) {
  int loaded = 0;
  for (const auto& entry : std::filesystem::directory_iterator(THIMBLE_SOURCE_DIR "/examples")) {
    if (entry.path().extension() != ".toml") continue;
    const auto sut = load(entry.path());
    EXPECT_TRUE(sut) << to_string(sut.error().front());
    ++loaded;
  }
  EXPECT_GE(loaded, 4);
}

TEST(Examples, FindTheFilesTheyName) {
  for (const char* name : {"volume", "scan"}) {
    const auto sut = load(std::string(THIMBLE_SOURCE_DIR "/examples/") + name + ".toml");
    ASSERT_TRUE(sut);
    EXPECT_TRUE(std::filesystem::exists(sut->worlds.at(0).source)) << sut->worlds.at(0).source;
  }
}

TEST(Examples, OfTwoHostsMeet) {
  const auto world = load(THIMBLE_SOURCE_DIR "/examples/world-host.toml");
  const auto arm = load(THIMBLE_SOURCE_DIR "/examples/arm-host.toml");
  ASSERT_TRUE(world && arm);
  EXPECT_EQ(world->worlds.at(0).listen, arm->arms.at(0).link);
  const auto host = load(THIMBLE_SOURCE_DIR "/examples/teleoperation-host.toml");
  const auto guest = load(THIMBLE_SOURCE_DIR "/examples/teleoperation-guest.toml");
  ASSERT_TRUE(host && guest);
  EXPECT_EQ(host->arms.at(0).listen, guest->arms.at(0).link);
}

}  // namespace
}  // namespace thimble::config
