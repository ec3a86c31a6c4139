#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "daemon/world/voxel_grid.hpp"

namespace thimble::world {

// The header of a volume of raw little-endian numbers, which follow it. `type` as NRRD calls it;
// `sizes` fastest axis first; `keys`: more lines of it, whole. Pure.
[[nodiscard]] std::string nrrd_head(std::string_view type,
                                    const std::array<std::uint32_t, 3>& sizes,
                                    std::string_view keys = {});
// A volume of bytes, as many as its sizes say.
[[nodiscard]] std::string nrrd_of_bytes(const std::array<std::uint32_t, 3>& sizes,
                                        std::span<const std::uint8_t> bytes);
// 1 where a grid is occupied, else 0; of grids with more than `most` cells one cell of each n in
// each direction, about the middle of its block, n the least with which that is so many at most,
// and "spacings" say n.
[[nodiscard]] std::string nrrd_of_grid(const VoxelGrid& grid, std::size_t most);

}  // namespace thimble::world
