#pragma once

#include <cstdint>
#include <optional>

#include "daemon/world/cell.hpp"
#include "daemon/world/ghost_slide.hpp"
#include "daemon/world/voxel_grid.hpp"
#include "hal/base/geometry.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::world {

// Where matter can be left: the point of a free cell nearest to the one asked about.
struct Exit {
  GhostPoint at{};
  double distance_m{0};
};

// What an exit is looked for: from where, and what decides between equally near ones.
struct ExitQuery {
  Position3 anchor{};     // distances are measured from here; finite, any size
  Displacement3 bias{};   // decides among equally near exits: the one farthest along it
  bool is_bound{false};   // an exit against the bias is none
  Cell home{};            // then the one fewest cells away from here
  std::int32_t reach{0};  // cells around the anchor's that are looked at
};

// The nearest free cell, by Euclidean distance to its closed box. Exits that nothing tells apart
// are passed over for the next nearest, so that the answer does not depend on the order of the
// axes; none when no single one is left.
//
// RT: THIMBLE_RT; looks at (2 reach + 2)^3 cells at most kMaxTies times.
[[nodiscard]] THIMBLE_RT std::optional<Exit> find_exit(const VoxelGrid& grid,
                                                       const ExitQuery& query) noexcept;

// a + b + c, the same bits in whatever order the three are given.
[[nodiscard]] THIMBLE_RT double symmetric_sum(double a, double b, double c) noexcept;

}  // namespace thimble::world
