#include "daemon/world/voxel_grid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/unit/world/grids.hpp"

namespace thimble::world {
namespace {

TEST(VoxelGrid, HoldsWhatADenseArrayHolds) {
  std::mt19937 random(1);
  VoxelGrid sut = empty_grid({7, 5, 13});
  std::vector<bool> oracle(7 * 5 * 13, false);
  for (int step = 0; step < 5000; ++step) {
    const Cell c{index_below(random, 7), index_below(random, 5), index_below(random, 13)};
    const bool is_occupied = random() % 2 == 0;
    sut.set_occupied(c, is_occupied);
    oracle[static_cast<std::size_t>(c.x + 7 * (c.y + 5 * c.z))] = is_occupied;
  }
  for_each_cell(sut, [&](Cell c) {
    ASSERT_EQ(sut.is_occupied(c), oracle[static_cast<std::size_t>(c.x + 7 * (c.y + 5 * c.z))]);
  });
}

TEST(VoxelGrid, OutsideIsOccupiedAndCannotBeCleared) {
  VoxelGrid sut = empty_grid({2, 3, 4});
  for (const Cell c : {Cell{-1, 0, 0}, Cell{2, 0, 0}, Cell{0, 3, 0}, Cell{0, 0, 4},
                       Cell{0, -2147483647, 0}, Cell{0, 0, 2147483647}}) {
    sut.set_occupied(c, false);
    EXPECT_TRUE(sut.is_occupied(c));
  }
  for_each_cell(sut, [&](Cell c) { EXPECT_FALSE(sut.is_occupied(c)); });
}

TEST(VoxelGrid, FacesMirrorExactlyForEveryCount) {
  for (std::uint32_t count = 1; count <= 1024; ++count) {
    const VoxelGrid sut = empty_grid({count, 1, 1}, kDefaultWorkspace_m / count);
    const auto n = static_cast<std::int32_t>(count);
    for (std::int32_t i = 0; i <= n; ++i) ASSERT_EQ(sut.face_m(0, i), -sut.face_m(0, n - i));
    for (std::int32_t i = 0; i < n; ++i) ASSERT_LT(sut.face_m(0, i), sut.face_m(0, i + 1));
  }
}

TEST(VoxelGrid, LowerIndexIsTheCellWhoseHalfOpenIntervalHoldsThePoint) {
  std::mt19937 random(2);
  const VoxelGrid sut = empty_grid({11, 1, 1}, 0.09 / 11);
  for (std::int32_t i = 1; i < 11; ++i) {
    const double face = sut.face_m(0, i);
    EXPECT_EQ(sut.lower_index(0, face), i - 1);
    EXPECT_EQ(sut.lower_index(0, std::nextafter(face, 1)), i);
    EXPECT_EQ(sut.lower_index(0, std::nextafter(face, -1)), i - 1);
  }
  for (const double far : {0.0451, 1e300}) {
    EXPECT_EQ(sut.lower_index(0, far), 10);
    EXPECT_EQ(sut.lower_index(0, -far), 0);
  }
}

TEST(VoxelGrid, NextFreeInRowSkipsWhatIsOccupied) {
  std::mt19937 random(3);
  VoxelGrid sut = empty_grid({150, 2, 2});
  for_each_cell(sut, [&](Cell c) { sut.set_occupied(c, random() % 40 != 0); });
  for_each_cell(sut, [&](Cell c) {
    std::int32_t expected = c.x;
    while (expected < 150 && sut.is_occupied({expected, c.y, c.z})) ++expected;
    ASSERT_EQ(sut.next_free_in_row(c), expected);
  });
}

TEST(VoxelGrid, TakesAtMostASeventhOfAByteAVoxel) {
  for (const std::uint32_t count : {64U, 100U, 256U}) {
    const VoxelGrid sut = empty_grid({count, count, count}, 0.001);
    const double voxels = std::pow(count, 3);
    EXPECT_LE(static_cast<double>(sut.memory_bytes() + sizeof sut), voxels / 7);
  }
}

TEST(VoxelGrid, RefusesCountsAndSizesOutOfRange) {
  for (const std::uint32_t count : {0U, 1025U, 0xFFFFFFFFU}) {
    const auto sut = VoxelGrid::create({4, count, 4}, 0.01);
    ASSERT_FALSE(sut);
    EXPECT_EQ(sut.error().code, Errc::InvalidArgument);
    EXPECT_NE(sut.error().message.find("1024"), std::string::npos);
  }
  for (const double cell_m : {0.0, -1.0, 1e-12, 1e9, std::nan("")}) {
    EXPECT_FALSE(VoxelGrid::create({4, 4, 4}, cell_m));
  }
}

TEST(MakeBox, OfThreeIsTheThesisBox) {
  const VoxelGrid sut = make_box(3).value();
  EXPECT_DOUBLE_EQ(sut.cell_m(), 0.030);
  for_each_cell(sut, [&](Cell c) { EXPECT_EQ(sut.is_occupied(c), c != (Cell{1, 1, 1})); });
  // teleop.md 4: world planes at -45, -15, +15, +45 mm.
  EXPECT_DOUBLE_EQ(sut.face_m(0, 0), -0.045);
  EXPECT_DOUBLE_EQ(sut.face_m(0, 1), -0.015);
  EXPECT_DOUBLE_EQ(sut.face_m(0, 2), 0.015);
}

TEST(MakeBox, OfSixtyFourHas262144Cells) {
  const VoxelGrid sut = make_box(64).value();
  int cells = 0;
  for_each_cell(sut, [&](Cell) { ++cells; });
  EXPECT_EQ(cells, 262144);
  EXPECT_EQ(sut.memory_bytes(), 262144U / 8);
}

TEST(MakeBox, FreesTheCellsWhoseCentreIsInTheMiddleThird) {
  for (const std::uint32_t count : {3U, 4U, 5U, 6U, 7U, 8U, 9U, 16U, 17U, 30U, 32U, 64U}) {
    const VoxelGrid sut = make_box(count).value();
    int free = 0;
    for_each_cell(sut, [&](Cell c) {
      const Position3 center = center_of(sut, c);
      bool is_middle = true;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        is_middle = is_middle && std::abs(center[axis]) < kDefaultWorkspace_m / 6 - 1e-9;
      }
      ASSERT_EQ(sut.is_occupied(c), !is_middle) << count;
      free += is_middle ? 1 : 0;
    });
    EXPECT_GT(free, 0) << count;
  }
  EXPECT_EQ(make_box(256)->next_free_in_row({0, 128, 128}), 85);
}

TEST(MakeBox, RefusesSizesOutOfRange) {
  for (const std::uint32_t count : {0U, 1U, 2U, 1025U}) EXPECT_FALSE(make_box(count));
  EXPECT_FALSE(make_box(3, 0));
}

TEST(VoxelGrid, ItsRevisionGrowsWithEveryChangeAndWithNothingElse) {
  VoxelGrid sut = VoxelGrid::create({70, 3, 2}, 0.01).value();
  const auto grows = [&](const auto& change) {
    const std::uint64_t before = sut.revision();
    change();
    return sut.revision() > before;
  };
  EXPECT_TRUE(grows([&] { sut.set_occupied({1, 1, 1}, true); }));
  EXPECT_FALSE(grows([&] { sut.set_occupied({1, 1, 1}, true); }));
  EXPECT_FALSE(grows([&] { sut.set_occupied({-1, 1, 1}, true); }));
  EXPECT_TRUE(grows([&] { (void)sut.set_row({0, 2, 1}, 70, true); }));
  EXPECT_FALSE(grows([&] { (void)sut.set_row({5, 2, 1}, 60, true); }));
  EXPECT_TRUE(grows([&] { sut.set_word(0, 77); }));
  EXPECT_FALSE(grows([&] { sut.set_word(0, 77); }));
  EXPECT_TRUE(grows([&] { sut.fill(); }));
  VoxelGrid other = VoxelGrid::create({70, 3, 2}, 0.01).value();
  other.fill();
  EXPECT_EQ(other, sut) << "what they are counts, not how they came to it";
}

}  // namespace
}  // namespace thimble::world
