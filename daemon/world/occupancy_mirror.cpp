#include "daemon/world/occupancy_mirror.hpp"

#include "daemon/world/voxel_grid.hpp"

namespace thimble::world {

bool OccupancyMirror::begin(const CellLattice& lattice) noexcept {
  for (OccupancyBlock& slot : slots_) slot.version = 0;
  const bool is_possible = VoxelGrid::is_possible(lattice);
  lattice_ = is_possible ? lattice : CellLattice{};
  return is_possible;
}

bool OccupancyMirror::learn(const OccupancyBlock& block) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int32_t first = block.at[axis] * kBlockEdge_cells;
    if (first < 0 || static_cast<std::uint32_t>(first) >= lattice_.cells[axis]) return false;
  }
  OccupancyBlock& slot = slots_[slot_of(block.at)];
  if (block.version <= slot.version) return false;
  slot = block;
  return true;
}

// Of a cell that is inside.
const OccupancyBlock* OccupancyMirror::find(Cell cell) const noexcept {
  const std::array<std::int16_t, 3> at = block_of(cell);
  const OccupancyBlock& slot = slots_[slot_of(at)];
  return slot.version > 0 && slot.at == at ? &slot : nullptr;
}

bool OccupancyMirror::is_known(Cell cell) const noexcept {
  return !lattice_.is_inside(cell) || find(cell) != nullptr;
}

bool OccupancyMirror::is_occupied(Cell cell) const noexcept {
  if (!lattice_.is_inside(cell)) return true;
  const OccupancyBlock* const block = find(cell);
  if (block == nullptr) return false;
  constexpr auto kEdge = static_cast<std::uint32_t>(kBlockEdge_cells);
  const std::uint32_t bit = static_cast<std::uint32_t>(cell.x) % kEdge +
                            kEdge * (static_cast<std::uint32_t>(cell.y) % kEdge);
  return ((block->slices[static_cast<std::uint32_t>(cell.z) % kEdge] >> bit) & 1U) != 0;
}

}  // namespace thimble::world
