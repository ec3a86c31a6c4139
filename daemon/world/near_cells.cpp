#include "daemon/world/near_cells.hpp"

#include <cmath>

#include "daemon/world/voxel_grid.hpp"

namespace thimble::world {

bool is_sound(const NearCells& near, Position3 ghost) noexcept {
  if (!VoxelGrid::is_possible(near.lattice)) return false;
  if (!near.lattice.is_inside(near.middle)) return false;
  if (near.is_plane && near.lattice.cells[2] != 1) return false;
  for (std::size_t axis = 0; axis < (near.is_plane ? 2U : 3U); ++axis) {
    const std::int32_t cell = near.middle[axis];
    if (!(ghost[axis] >= near.face_m(axis, cell) && ghost[axis] <= near.face_m(axis, cell + 1))) {
      return false;
    }
  }
  return std::isfinite(ghost.z);
}

}  // namespace thimble::world
