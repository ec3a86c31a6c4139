#pragma once

#include <array>
#include <cstdint>

#include "daemon/world/cell.hpp"
#include "daemon/world/near_cells.hpp"
#include "daemon/world/occupancy_mirror.hpp"
#include "daemon/world/voxel_grid.hpp"
#include "hal/base/geometry.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::world {

// A ghost point and the cell it is in. The cell is state of its own: a point on a face belongs
// to the cell it came from, which the position alone cannot tell.
struct GhostPoint {
  Position3 position{};  // within the closed box of `cell`
  Cell cell{};
  bool operator==(const GhostPoint&) const = default;
};

struct Slide {
  GhostPoint ghost{};
  // Per axis: +1 / -1 when the upper / lower face of the ghost's cell holds it there or is
  // touched by the target; 0 when the axis is free.
  std::array<std::int8_t, 3> held{};
};

// Moves a point straight towards `target`, from cell to cell through faces, never into an
// occupied cell (the cell it starts in is not asked). An axis that meets an occupied cell stops
// exactly on the face; the others go on, and the stopped one goes on with them as soon as they
// have carried the point past the edge (thesis 3.7.1, figure 3-9c). The rule for exact ties is in
// docs/ghost-motion.md; exchanging or mirroring axes of grid, point and target does the same to
// the result, bit for bit.
//
// RT: THIMBLE_RT; bounded by the cells along the way, whatever the size of the grid.
// Errors: none; `target` must be finite, any size.
[[nodiscard]] THIMBLE_RT Slide slide_ghost(const VoxelGrid& grid, GhostPoint from,
                                           Position3 target) noexcept;
// The same through what is known of a grid: as long as the cells that are met are, bit for bit.
[[nodiscard]] THIMBLE_RT Slide slide_ghost(const NearCells& near, GhostPoint from,
                                           Position3 target) noexcept;
[[nodiscard]] THIMBLE_RT Slide slide_ghost(const OccupancyMirror& mirror, GhostPoint from,
                                           Position3 target) noexcept;

}  // namespace thimble::world
