#include "daemon/world/near_cell_finder.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace thimble::world {
namespace {

// How much of a reach is tried next when there are too many boxes; ours.
constexpr double kShorter = 0.75;

}  // namespace

std::int32_t zone_cells(double reach_m, double cell_m) noexcept {
  const double whole = std::floor(reach_m / cell_m);
  return whole < kNearReach_cells ? static_cast<std::int32_t>(std::max(0.0, whole)) + 1
                                  : kNearReach_cells;
}

NearCells NearCellFinder::find(const VoxelGrid& grid, const NearQuery& query) noexcept {
  NearCells near = nothing(grid, query);
  if (!near.lattice.is_inside(query.middle)) return near;
  NearQuery shorter = query;
  do {
    if (name(grid, region_of(grid, shorter), near)) return near;
    shorter.reach_m *= kShorter;
  } while (shorter.reach_m >= grid.cell_m());
  name(grid, neighbors_of(grid, query.middle), near);
  return near;
}

NearCells NearCellFinder::nothing(const VoxelGrid& grid, const NearQuery& query) noexcept {
  NearCells near;
  near.lattice = grid.lattice();
  near.middle = query.middle;
  near.is_plane = query.is_plane;
  if (near.lattice.is_inside(query.middle)) near.known = counted(near, region_of(grid, query));
  return near;
}

CellBox NearCellFinder::counted(const NearCells& near, const Region& region) noexcept {
  const Cell first = near.counted(region.first);
  const Cell last = near.counted(region.last);
  CellBox box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.first[axis] = static_cast<std::int8_t>(first[axis]);
    box.last[axis] = static_cast<std::int8_t>(last[axis]);
  }
  return box;
}

NearCellFinder::Region NearCellFinder::region_of(const VoxelGrid& grid,
                                                 const NearQuery& query) noexcept {
  const Position3 hand = grid.clamp_near(query.hand);
  Region region;
  for (std::size_t axis = 0; axis < (query.is_plane ? 2U : 3U); ++axis) {
    const std::int32_t middle = query.middle[axis];
    const double low_m = std::min(query.ghost[axis], hand[axis]) - query.reach_m;
    const double high_m = std::max(query.ghost[axis], hand[axis]) + query.reach_m;
    region.first[axis] =
        std::clamp(grid.lower_index(axis, low_m), middle - kNearReach_cells, middle);
    region.last[axis] =
        std::clamp(grid.upper_index(axis, high_m), middle, middle + kNearReach_cells);
  }
  return region;
}

NearCellFinder::Region NearCellFinder::neighbors_of(const VoxelGrid& grid, Cell middle) noexcept {
  Region region;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto top = static_cast<std::int32_t>(grid.cells()[axis]) - 1;
    region.first[axis] = std::max(middle[axis] - 1, 0);
    region.last[axis] = std::min(middle[axis] + 1, top);
  }
  return region;
}

bool NearCellFinder::name(const VoxelGrid& grid, const Region& region, NearCells& near) noexcept {
  const Cell from{near.middle.x - kNearReach_cells, near.middle.y - kNearReach_cells,
                  near.middle.z - kNearReach_cells};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    first_[axis] = static_cast<std::size_t>(region.first[axis] - from[axis]);
    last_[axis] = static_cast<std::size_t>(region.last[axis] - from[axis]);
  }
  const std::size_t count = last_[0] - first_[0] + 1;
  for (std::size_t z = first_[2]; z <= last_[2]; ++z) {
    for (std::size_t y = first_[1]; y <= last_[1]; ++y) {
      const Cell row{region.first.x, from.y + static_cast<std::int32_t>(y),
                     from.z + static_cast<std::int32_t>(z)};
      left_[z][y] = grid.bits_in_row(row, count) << first_[0];
    }
  }
  near.known = counted(near, region);
  near.boxes.clear();
  for (std::size_t z = first_[2]; z <= last_[2]; ++z) {
    for (std::size_t y = first_[1]; y <= last_[1]; ++y) {
      while (left_[z][y] != 0) {
        if (!near.boxes.push_back(take_box(y, z))) return false;
      }
    }
  }
  return true;
}

// The first run of the row, and as many rows and layers behind it as have all of it.
CellBox NearCellFinder::take_box(std::size_t y, std::size_t z) noexcept {
  const auto x = static_cast<std::size_t>(std::countr_zero(left_[z][y]));
  const auto count = static_cast<std::size_t>(std::countr_one(left_[z][y] >> x));
  const std::uint64_t run = ((std::uint64_t{1} << count) - 1) << x;
  const auto has_run = [&](std::size_t in_y, std::size_t in_z) {
    return (left_[in_z][in_y] & run) == run;
  };
  std::size_t end_y = y + 1;
  while (end_y <= last_[1] && has_run(end_y, z)) ++end_y;
  const auto has_rows = [&](std::size_t in_z) {
    for (std::size_t in_y = y; in_y < end_y; ++in_y) {
      if (!has_run(in_y, in_z)) return false;
    }
    return true;
  };
  std::size_t end_z = z + 1;
  while (end_z <= last_[2] && has_rows(end_z)) ++end_z;
  for (std::size_t in_z = z; in_z < end_z; ++in_z) {
    for (std::size_t in_y = y; in_y < end_y; ++in_y) left_[in_z][in_y] &= ~run;
  }
  const auto counted = [](std::size_t i) {
    return static_cast<std::int8_t>(static_cast<std::int32_t>(i) - kNearReach_cells);
  };
  return {.first = {counted(x), counted(y), counted(z)},
          .last = {counted(x + count - 1), counted(end_y - 1), counted(end_z - 1)}};
}

}  // namespace thimble::world
