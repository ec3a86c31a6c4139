#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "daemon/world/cell.hpp"
#include "daemon/world/cell_lattice.hpp"
#include "hal/base/geometry.hpp"
#include "hal/rt/annotations.hpp"
#include "hal/rt/static_vector.hpp"

namespace thimble::world {

// How far from the cell in the middle occupied ones are named: a row of them fits into a word.
inline constexpr std::int32_t kNearReach_cells = 31;
// Ours: the 26 neighbors of a cell fit, whatever they are; beyond, larger boxes have to do.
inline constexpr std::size_t kMaxNearBoxes = 32;

// Cells from `first` to `last`, both included, counted from the cell in the middle.
struct CellBox {
  std::array<std::int8_t, 3> first{};
  std::array<std::int8_t, 3> last{};

  [[nodiscard]] bool has(Cell at) const noexcept {
    return at.x >= first[0] && at.x <= last[0] && at.y >= first[1] && at.y <= last[1] &&
           at.z >= first[2] && at.z <= last[2];
  }
  bool operator==(const CellBox&) const = default;
};

// The occupied cells near a place, as somebody is told who does not have the grid (thesis 3.6,
// figure 3-5b). To him the cells that are not named are free, but for those outside the world. A
// value: it crosses threads by copying.
//
// Thread: one at a time. RT: THIMBLE_RT.
struct NearCells {
  CellLattice lattice{};
  Cell middle{};
  rt::StaticVector<CellBox, kMaxNearBoxes> boxes{};
  CellBox known{};       // of what is beyond, nothing is said
  bool is_plane{false};  // the third axis is free, and has one cell

  [[nodiscard]] double face_m(std::size_t axis, std::int32_t index) const noexcept {
    return lattice.face_m(axis, index);
  }
  [[nodiscard]] Position3 clamp_near(Position3 p) const noexcept { return lattice.clamp_near(p); }
  [[nodiscard]] THIMBLE_RT bool is_occupied(Cell cell) const noexcept {
    if (!lattice.is_inside(cell)) return true;
    const Cell at = counted(cell);
    return std::any_of(boxes.begin(), boxes.end(),
                       [at](const CellBox& box) { return box.has(at); });
  }
  // Of a cell that is in the grid.
  [[nodiscard]] THIMBLE_RT bool is_known(Cell cell) const noexcept {
    return known.has(counted(cell));
  }
  // From the cell in the middle.
  [[nodiscard]] Cell counted(Cell cell) const noexcept {
    return {cell.x - middle.x, cell.y - middle.y, cell.z - middle.z};
  }
};

// Whether a ghost can be moved through it that starts at `ghost` in the cell in the middle: the
// grid can be one, and the place is in that cell.
[[nodiscard]] THIMBLE_RT bool is_sound(const NearCells& near, Position3 ghost) noexcept;

}  // namespace thimble::world
