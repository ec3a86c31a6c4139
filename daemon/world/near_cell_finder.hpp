#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "daemon/world/near_cells.hpp"
#include "daemon/world/voxel_grid.hpp"
#include "hal/base/geometry.hpp"

namespace thimble::world {

// Where to look: the cells that touch the box between ghost and hand, widened by `reach_m` on every
// side, as far as kNearReach_cells. What moves from that ghost after that hand, each axis towards
// it, meets no other cell until the hand has moved on by `reach_m`.
struct NearQuery {
  Cell middle{};  // of the ghost
  Position3 ghost{};
  Position3 hand{};
  double reach_m{0};
  bool is_plane{false};
};

// A zone of so many cells around what is occupied holds every cell that has some of it within
// `reach_m` of it, closed; kNearReach_cells at most.
[[nodiscard]] std::int32_t zone_cells(double reach_m, double cell_m) noexcept;

// Finds them in a grid. What does not fit into kMaxNearBoxes is not named: `reach_m` falls by a
// quarter until the rest fits; the 26 neighbors of the cell in the middle always do. Which way
// boxes are joined depends on the order of the axes, so that is the one thing that may differ when
// they are exchanged.
//
// Thread: the world's. Not RT; find() neither allocates nor blocks, and looks at some 4000 words of
// the grid at most for each reach it tries.
class NearCellFinder {
 public:
  [[nodiscard]] NearCells find(const VoxelGrid& grid, const NearQuery& query) noexcept;
  // The same, where it is known that nothing is occupied there.
  [[nodiscard]] static NearCells nothing(const VoxelGrid& grid, const NearQuery& query) noexcept;

 private:
  struct Region {
    Cell first{};
    Cell last{};
  };
  static constexpr std::size_t kAcross = 2 * kNearReach_cells + 1;
  static_assert(kAcross < 64, "shifts of a word below");

  [[nodiscard]] static Region region_of(const VoxelGrid& grid, const NearQuery& query) noexcept;
  [[nodiscard]] static Region neighbors_of(const VoxelGrid& grid, Cell middle) noexcept;
  [[nodiscard]] static CellBox counted(const NearCells& near, const Region& region) noexcept;
  // False: there is no room for all of it.
  bool name(const VoxelGrid& grid, const Region& region, NearCells& near) noexcept;
  [[nodiscard]] CellBox take_box(std::size_t y, std::size_t z) noexcept;

  // Counted from the lowest cells that can be named, along x, y, z; both included.
  std::array<std::size_t, 3> first_{};
  std::array<std::size_t, 3> last_{};
  // What is in no box yet: rows along x by z and y.
  std::array<std::array<std::uint64_t, kAcross>, kAcross> left_{};
};

}  // namespace thimble::world
