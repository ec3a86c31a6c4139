#include "daemon/session/entry.hpp"

#include <gtest/gtest.h>

#include <random>
#include <utility>

#include "daemon/world/sphere_world.hpp"
#include "daemon/world/voxel_world.hpp"

namespace thimble::session {
namespace {

constexpr std::array<double, 3> kHere{};

world::VoxelWorld world_of(world::VoxelGrid grid) { return {std::move(grid), "test"}; }

bool is_free_along(const world::VoxelGrid& grid, std::size_t axis, std::int32_t layer) {
  for (std::int32_t z = 0; z < static_cast<std::int32_t>(grid.cells()[2]); ++z) {
    for (std::int32_t y = 0; y < static_cast<std::int32_t>(grid.cells()[1]); ++y) {
      for (std::int32_t x = 0; x < static_cast<std::int32_t>(grid.cells()[0]); ++x) {
        const std::array<std::int32_t, 3> at{x, y, z};
        if (at.at(axis) == layer && !grid.is_occupied({x, y, z})) return true;
      }
    }
  }
  return false;
}

TEST(EntryInto, OfTheThesissBoxIsTheCellInItsMiddle) {
  world::VoxelGrid grid = *world::VoxelGrid::create({3, 3, 3}, 0.03);
  grid.fill();
  grid.set_occupied({1, 1, 1}, false);
  const servo::EntryBox sut = entry_into(world_of(std::move(grid)), {0, 0.2, -0.1});
  for (const double half_m : sut.half_m) EXPECT_NEAR(half_m, 0.015, 1e-12);
  EXPECT_NEAR(sut.center.x, 0, 1e-12);
  EXPECT_NEAR(sut.center.y, -0.2, 1e-12);
  EXPECT_NEAR(sut.center.z, 0.1, 1e-12);
}

TEST(EntryInto, OfAWorldThatIsMatterEverywhereIsAllOfIt) {
  world::VoxelGrid grid = *world::VoxelGrid::create({2, 4, 6}, 0.01);
  grid.fill();
  const servo::EntryBox sut = entry_into(world_of(std::move(grid)), kHere);
  EXPECT_EQ(sut.half_m, (std::array{0.01, 0.02, 0.03}));
}

TEST(EntryInto, OfAWorldWithoutEndIsEverywhere) {
  world::SphereScene scene;
  scene.radius_m = 0.05;
  scene.floor_m = -0.1;
  const auto ball = world::SphereWorld::create(scene);
  ASSERT_TRUE(ball) << ball.error().message;
  EXPECT_TRUE(entry_into(*ball, kHere).contains({9, 9, 9}));
}

// Every free cell's middle is in it, and each of its faces has a free cell behind it.
TEST(EntryInto, IsTheSmallestBoxAroundAllThatIsFree) {
  std::mt19937_64 random(6);
  for (int turn = 0; turn < 300; ++turn) {
    const auto count = [&] { return static_cast<std::uint32_t>(1 + random() % 7); };
    world::VoxelGrid grid = *world::VoxelGrid::create({count(), count(), count()}, 0.01);
    grid.fill();
    const std::array<std::uint32_t, 3> cells = grid.cells();
    for (std::uint64_t free = 1 + random() % 6; free > 0; --free) {
      grid.set_occupied({static_cast<std::int32_t>(random() % cells[0]),
                         static_cast<std::int32_t>(random() % cells[1]),
                         static_cast<std::int32_t>(random() % cells[2])},
                        false);
    }
    const world::VoxelGrid kept = grid;
    const servo::EntryBox sut = entry_into(world_of(std::move(grid)), kHere);
    const std::array<double, 3> center_m{sut.center.x, sut.center.y, sut.center.z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::int32_t first = 0;
      auto last = static_cast<std::int32_t>(cells.at(axis)) - 1;
      while (!is_free_along(kept, axis, first)) ++first;
      while (!is_free_along(kept, axis, last)) --last;
      EXPECT_NEAR(center_m.at(axis) - sut.half_m.at(axis), kept.face_m(axis, first), 1e-12);
      EXPECT_NEAR(center_m.at(axis) + sut.half_m.at(axis), kept.face_m(axis, last + 1), 1e-12);
    }
  }
}

// 1024 layers of a million cells would be read for seconds.
TEST(EntryInto, OfAThickWallIsFoundOnlyAsFarAsItLooks) {
  world::VoxelGrid grid = *world::VoxelGrid::create({256, 256, 256}, 0.001);
  grid.fill();
  grid.set_occupied({128, 128, 128}, false);
  const servo::EntryBox sut = entry_into(world_of(std::move(grid)), kHere);
  EXPECT_GT(sut.half_m[0], 0.1) << "16 layers, of 128";
  EXPECT_LT(sut.half_m[0], 0.128);
  EXPECT_TRUE(sut.contains({0.0005, 0.0005, 0.0005}));
}

}  // namespace
}  // namespace thimble::session
