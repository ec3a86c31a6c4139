#include "daemon/world/material_map.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <tuple>
#include <utility>

#include "daemon/world/voxel_world.hpp"

namespace thimble::world {
namespace {

std::vector<Material> materials(std::size_t count) {
  std::vector<Material> out;
  for (std::size_t i = 1; i <= count; ++i) out.push_back({{100.0 * static_cast<double>(i)}, {1}});
  return out;
}

TEST(MaterialMap, RemembersEveryLabelBesideItsNeighbours) {
  std::mt19937 random(11);
  for (const std::size_t count : {1U, 2U, 3U, 4U, 15U}) {
    const auto known = materials(count);
    auto sut = MaterialMap::create({5, 7, 3}, known);
    ASSERT_TRUE(sut);
    std::map<std::tuple<int, int, int>, std::size_t> expected;
    for (int i = 0; i < 2000; ++i) {
      const Cell cell{static_cast<int>(random() % 7) - 1, static_cast<int>(random() % 9) - 1,
                      static_cast<int>(random() % 5) - 1};
      const auto label = static_cast<std::uint8_t>(random() % (count + 2));
      sut->set(cell, label);
      const bool is_kept = label <= count && cell.x >= 0 && cell.x < 5 && cell.y >= 0 &&
                           cell.y < 7 && cell.z >= 0 && cell.z < 3;
      if (is_kept) expected[{cell.x, cell.y, cell.z}] = label;
    }
    for (Cell cell{-1, -1, -1}; cell.z < 4; ++cell.z) {
      for (cell.y = -1; cell.y < 8; ++cell.y) {
        for (cell.x = -1; cell.x < 6; ++cell.x) {
          const std::size_t label = expected[{cell.x, cell.y, cell.z}];
          ASSERT_EQ(sut->at(cell), label == 0 ? Material{} : known[label - 1]);
        }
      }
    }
  }
}

TEST(MaterialMap, TakesAFewBitsACellAndNothingWithoutMaterials) {
  const auto bytes = [](std::size_t count) {
    return MaterialMap::create({64, 64, 64}, materials(count))->memory_bytes();
  };
  constexpr std::size_t kCells = 64 * 64 * 64;
  EXPECT_EQ(bytes(0), 0U);
  EXPECT_EQ(bytes(1), kCells / 8);
  EXPECT_EQ(bytes(3), kCells / 4);
  EXPECT_EQ(bytes(15), kCells / 2);
  EXPECT_EQ(MaterialMap::create({1, 1, 1}, materials(16)).error().message,
            "materials: 16; the limit is 15");
}

// Two cells of free space in a row, the left wall soft, the right one hard.
VoxelWorld two_materials() {
  VoxelGrid grid = *VoxelGrid::create({4, 3, 3}, 0.01);
  grid.fill();
  grid.set_occupied({1, 1, 1}, false);
  grid.set_occupied({2, 1, 1}, false);
  auto map = *MaterialMap::create({4, 3, 3}, {{{200}, {2}, 0.3, 310}, {{900}, {9}}});
  for (Cell cell; cell.z < 3; ++cell.z) {
    for (cell.y = 0; cell.y < 3; ++cell.y) {
      for (cell.x = 0; cell.x < 4; ++cell.x) map.set(cell, cell.x < 2 ? 1 : 2);
    }
  }
  return VoxelWorld(std::move(grid), "two", std::move(map));
}

TEST(VoxelWorldMaterial, APlaneFeelsAsTheCellThatIsTouched) {
  VoxelWorld sut = two_materials();
  const ProbeId probe = *sut.add_probe({-0.005, 0, 0});
  const auto stiffness_at = [&](Position3 hand) {
    const ProbeMotion motion = sut.move_probe(probe, hand, std::chrono::milliseconds(1));
    EXPECT_EQ(motion.planes.size(), 1U);
    return motion.planes.empty() ? 0 : motion.planes.begin()->stiffness.newton_per_m;
  };
  EXPECT_EQ(stiffness_at({-0.013, 0, 0}), 200);
  EXPECT_EQ(stiffness_at({-0.005, 0, 0.008}), 200);  // the ceiling above the left cell
  EXPECT_EQ(stiffness_at({0.005, 0, 0.008}), 900);   // and above the right one
  EXPECT_EQ(stiffness_at({0.013, 0, 0}), 900);
}

TEST(VoxelWorldMaterial, ACellThatIsFilledLaterFeelsAsTheArmIsConfigured) {
  VoxelWorld sut = two_materials();
  const ProbeId probe = *sut.add_probe({-0.005, 0, 0});
  sut.set_cell({2, 1, 1}, true);
  const auto motion = sut.move_probe(probe, {0.004, 0, 0}, std::chrono::milliseconds(1));
  ASSERT_EQ(motion.planes.size(), 1U);
  EXPECT_EQ(motion.planes.begin()->stiffness, Stiffness{-1});
  sut.set_cell({0, 1, 1}, true);  // was full already: keeps its material
  const auto back = sut.move_probe(probe, {-0.013, 0, 0}, std::chrono::milliseconds(1));
  ASSERT_EQ(back.planes.size(), 1U);
  EXPECT_EQ(back.planes.begin()->damping, Damping{2});
  EXPECT_EQ(back.planes.begin()->friction, 0.3);
  EXPECT_EQ(back.planes.begin()->temperature_kelvin, 310);
}

}  // namespace
}  // namespace thimble::world
