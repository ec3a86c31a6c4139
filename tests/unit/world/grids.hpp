#pragma once

#include <cstdint>
#include <random>
#include <string_view>
#include <vector>

#include "daemon/world/ghost_motion.hpp"
#include "daemon/world/voxel_grid.hpp"

namespace thimble::world {

inline VoxelGrid empty_grid(std::array<std::uint32_t, 3> cells, double cell_m = 0.25) {
  return VoxelGrid::create(cells, cell_m).value();
}

// Calls `visit(cell)` for every cell of the grid.
template <class Visit>
void for_each_cell(const VoxelGrid& grid, Visit visit) {
  const auto& n = grid.cells();
  for (Cell c; c.z < static_cast<std::int32_t>(n[2]); ++c.z) {
    for (c.y = 0; c.y < static_cast<std::int32_t>(n[1]); ++c.y) {
      for (c.x = 0; c.x < static_cast<std::int32_t>(n[0]); ++c.x) visit(c);
    }
  }
}

inline Position3 center_of(const VoxelGrid& grid, Cell cell) {
  Position3 p;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    p[axis] = (grid.face_m(axis, cell[axis]) + grid.face_m(axis, cell[axis] + 1)) / 2;
  }
  return p;
}

inline GhostState ghost_in(const VoxelGrid& grid, Cell cell) {
  return {{center_of(grid, cell), cell}, GhostPhase::Loose, false};
}

inline double uniform(std::mt19937& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

inline std::int32_t index_below(std::mt19937& random, std::uint32_t end) {
  return static_cast<std::int32_t>(random() % end);
}

inline VoxelGrid random_grid(std::mt19937& random, double share_occupied, double cell_m) {
  std::array<std::uint32_t, 3> cells{};
  for (auto& count : cells) count = 2 + static_cast<std::uint32_t>(random() % 7);
  VoxelGrid grid = empty_grid(cells, cell_m);
  for_each_cell(grid,
                [&](Cell c) { grid.set_occupied(c, uniform(random, 0, 1) < share_occupied); });
  return grid;
}

// A random point of the world and a little around it; half of them on the lattice of half cells.
inline Position3 random_point(std::mt19937& random, const VoxelGrid& grid) {
  Position3 p;
  const bool is_on_lattice = random() % 2 == 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto count = static_cast<std::int32_t>(grid.cells()[axis]);
    if (is_on_lattice) {
      const auto i = static_cast<std::int32_t>(random() % (2 * grid.cells()[axis] + 5)) - 2;
      p[axis] = static_cast<double>(i - count) * (grid.cell_m() / 2);
    } else {
      p[axis] = uniform(random, grid.face_m(axis, -1), grid.face_m(axis, count + 1));
    }
  }
  return p;
}

// The force of a unit stiffness that the planes of a move put on the hand.
inline Force3 pull_on(Position3 hand, const ProbeMotion& motion) {
  Force3 force;
  for (const ContactPlane& plane : motion.planes) {
    const double depth_m = dot(plane.normal, hand) - plane.offset_m;
    if (depth_m <= 0) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) force[axis] -= plane.normal[axis] * depth_m;
  }
  return force;
}

}  // namespace thimble::world
