#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <string>

#include "daemon/world/io/nrrd.hpp"
#include "tests/unit/world/grids.hpp"
#include "tests/unit/world/nrrd_bytes.hpp"

namespace thimble::world {

inline std::string error_of(const Result<VoxelGrid>& sut) {
  return sut ? "none" : sut.error().message;
}

// A volume whose number [x, y, z] is 1 where (x, y, z) = (1, 2, 3).
inline NrrdBytes one_cell() {
  NrrdBytes bytes;
  bytes.data[1 + 2 * (2 + 3 * 3)] = 1;
  return bytes;
}
inline void expect_one_cell(const Result<VoxelGrid>& sut) {
  ASSERT_TRUE(sut) << error_of(sut);
  EXPECT_EQ(sut->cells(), (std::array<std::uint32_t, 3>{2, 3, 4}));
  for_each_cell(*sut, [&](Cell c) { EXPECT_EQ(sut->is_occupied(c), c == (Cell{1, 2, 3})); });
}

}  // namespace thimble::world
