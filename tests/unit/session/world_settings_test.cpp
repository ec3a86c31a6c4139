#include "daemon/session/world_settings.hpp"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cstdint>

#include "tests/support/temporary_folder.hpp"

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

TEST(WorldSettings, AFieldHasItsUnitItsPlaceAndItsSurface) {
  const testing_support::TemporaryFolder folder;
  config::WorldConfig said;
  said.source = folder.write("half.nrrd",
                             "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 2 2\n"
                             "encoding: text\n\n-1 -1 1 1 -1 -1 1 1\n");
  said.cell_m = 0.02;
  said.field = config::FieldConfig{
      .unit_m = 0.01, .center_m = {0, 0.1, 0}, .friction = 0.5, .temperature_kelvin = 280};
  const auto sut = make_world(said, nullptr);
  ASSERT_TRUE(sut) << sut.error().message;
  const auto probe = sut->world->add_probe({0, 0.2, 0});
  ASSERT_TRUE(probe);
  const auto motion = sut->world->move_probe(*probe, {0, 0.05, 0}, std::chrono::milliseconds(1));
  EXPECT_NEAR(motion.ghost.y, 0.1, 1e-4);
  ASSERT_EQ(motion.planes.size(), 1U);
  EXPECT_EQ(motion.planes[0].friction, 0.5);
  EXPECT_EQ(motion.planes[0].temperature_kelvin, 280);
  EXPECT_NEAR(motion.planes[0].offset_m, -0.1, 1e-6) << "as far as the middle of the field";
}

TEST(WorldSettings, AMeshBecomesAFieldOfItsSizeAtItsPlace) {
  config::WorldConfig said;
  said.source = THIMBLE_SOURCE_DIR "/examples/gem.obj";
  said.field = config::FieldConfig{
      .longest_m = 0.04, .is_mesh = true, .resolution = 20, .center_m = {0, 0, 0.05}};
  const auto sut = make_world(said, nullptr);
  ASSERT_TRUE(sut) << sut.error().message;
  const auto probe = sut->world->add_probe({0, 0.03, 0.05});
  ASSERT_TRUE(probe);
  const auto motion = sut->world->move_probe(*probe, {0, 0, 0.05}, std::chrono::milliseconds(1));
  ASSERT_EQ(motion.planes.size(), 1U);
  EXPECT_NEAR(motion.planes[0].normal.y, -1, 1e-6) << "on its table";
}

}  // namespace
}  // namespace thimble::session
