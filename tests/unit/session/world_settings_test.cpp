#include "daemon/session/world_settings.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>

namespace thimble::session {
namespace {

world::VolumeOptions with_order(const char* order) {
  config::WorldConfig said;
  said.axis_order = order;
  return volume_options(said);
}

TEST(WorldSettings, AMinusTurnsTheAxisOfTheFileThatItsLetterNames) {
  const auto plain = with_order("zxy");
  EXPECT_EQ(plain.axis_order, (std::array<std::uint8_t, 3>{2, 0, 1}));
  EXPECT_EQ(plain.is_reversed, (std::array{false, false, false}));
  const auto turned = with_order("-zx-y");
  EXPECT_EQ(turned.axis_order, plain.axis_order);
  EXPECT_EQ(turned.is_reversed, (std::array{true, false, true}));
}

TEST(WorldSettings, AMaterialThatSaysNothingLeavesTheArmItsOwn) {
  config::MaterialConfig bone;
  bone.friction = 0.2;
  config::WorldConfig said;
  said.materials.push_back(bone);
  const auto sut = volume_options(said);
  ASSERT_EQ(sut.materials.size(), 1U);
  EXPECT_EQ(sut.materials[0].material, (world::Material{{-1}, {-1}, 0.2}));
}

}  // namespace
}  // namespace thimble::session
