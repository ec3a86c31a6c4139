#pragma once

#include <cstdint>

#include "daemon/world/cell.hpp"
#include "daemon/world/voxel_world.hpp"
#include "hal/base/geometry.hpp"
#include "hal/base/result.hpp"

namespace thimble::world {

// Ours: beyond every grid, which ends 512 km from its origin (kMaxCellsPerAxis of 1e3 m), and far
// from where squares or sums of such numbers overflow.
inline constexpr double kMaxBrush_m = 1e6;

// One wish to change cells of a world.
struct CellEdit {
  enum class Kind : std::uint8_t {
    Fill,   // every cell from `first` to `last`
    Box,    // of these the six outer layers; what they enclose stays as it is
    Paint,  // every cell whose centre is within `radius_m` of `center`, where there are such
  };
  Kind kind{Kind::Fill};
  Cell first{};  // ends included; {0, 0, 0} is the corner where x, y and z are least
  Cell last{};
  Position3 center{};  // world frame, from the middle of the world; hand plus offset
  double radius_m{0};
  // What the cells become: 0 free, 1 filled and of no material, 1 + n of the n-th material.
  std::uint8_t value{1};
  bool operator==(const CellEdit&) const = default;
};

// InvalidArgument: not within the world, no such material, ends the wrong way round, a brush
// beyond kMaxBrush_m or without size.
[[nodiscard]] Result<void> check_edit(const VoxelWorld& world, const CellEdit& edit);

}  // namespace thimble::world
