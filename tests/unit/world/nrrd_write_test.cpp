#include "daemon/world/io/nrrd_write.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "daemon/world/io/nrrd.hpp"
#include "daemon/world/io/nrrd_header.hpp"
#include "tests/unit/world/npy_bytes.hpp"

namespace thimble::world {
namespace {

using GridSizes = std::array<std::uint32_t, 3>;

VoxelGrid random_grid(const GridSizes& sizes, std::mt19937& random) {
  VoxelGrid grid = VoxelGrid::create(sizes, 0.01).value();
  for (std::size_t i = 0; i < grid.words().size(); ++i) {
    grid.set_word(i, std::uint64_t{random()} << 32 | random());
  }
  return grid;
}

TEST(NrrdWrite, WhatIsWrittenIsReadBackCellForCell) {
  std::mt19937 random(4);
  for (const GridSizes& sizes : {GridSizes{1, 1, 1}, {7, 3, 5}, {64, 2, 9}}) {
    const VoxelGrid grid = random_grid(sizes, random);
    const std::string written = nrrd_of_grid(grid, 2000);
    MemorySource file(bytes_of(written));
    const auto read =
        load_nrrd(file, [](const auto& name) { return fail(Errc::NotFound, name); }, {});
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_EQ(read->cells(), sizes);
    for (std::int32_t z = 0; z < static_cast<std::int32_t>(sizes[2]); ++z) {
      for (std::int32_t y = 0; y < static_cast<std::int32_t>(sizes[1]); ++y) {
        for (std::int32_t x = 0; x < static_cast<std::int32_t>(sizes[0]); ++x) {
          ASSERT_EQ(read->is_occupied({x, y, z}), grid.is_occupied({x, y, z}));
        }
      }
    }
  }
}

TEST(NrrdWrite, ALargerGridIsWrittenInStepsAsLongAsNeeded) {
  std::mt19937 random(5);
  for (const auto& [sizes, most, every] :
       {std::tuple<GridSizes, std::size_t, std::uint32_t>{{16, 16, 16}, 4096, 1},
        {{16, 16, 16}, 4095, 2},
        {{10, 1, 7}, 12, 3},
        {{1000, 30, 2}, 1, 1000}}) {
    const VoxelGrid grid = random_grid(sizes, random);
    const std::string file = nrrd_of_grid(grid, most);
    const auto header = parse_nrrd_header(file, true);
    ASSERT_TRUE(header) << header.error().message;
    EXPECT_EQ(header->spacing.value_or(std::array<double, 3>{1, 1, 1})[1], every);
    const auto& shown = header->sizes;
    ASSERT_EQ(file.size() - header->header_bytes, std::size_t{1} * shown[0] * shown[1] * shown[2]);
    ASSERT_LE(file.size() - header->header_bytes, most);
    for (std::uint32_t i = 0; i < shown[0] * shown[1] * shown[2]; ++i) {
      const GridSizes at{i % shown[0], i / shown[0] % shown[1], i / shown[0] / shown[1]};
      std::array<std::int32_t, 3> cell{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(shown[axis], (sizes[axis] + every - 1) / every);
        const std::uint32_t middle = std::min(at[axis] * every + every / 2, sizes[axis] - 1);
        cell[axis] = static_cast<std::int32_t>(middle);
      }
      ASSERT_EQ(file[header->header_bytes + i],
                static_cast<char>(grid.is_occupied({cell[0], cell[1], cell[2]})));
    }
  }
}

}  // namespace
}  // namespace thimble::world
