#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "daemon/world/cell.hpp"
#include "hal/base/geometry.hpp"

namespace thimble::world {

// Where the cubic cells of a grid lie, whoever knows what is in them: centred on the world's
// origin, cell i of an axis between face_m(axis, i) and face_m(axis, i + 1).
//
// Thread: any. RT: THIMBLE_RT. Units, frame: m, world frame.
struct CellLattice {
  std::array<std::uint32_t, 3> cells{};
  double half_cell_m{0};

  // Faces mirror exactly: face_m(a, n - i) == -face_m(a, i), because the only rounding is that
  // of one product.
  [[nodiscard]] double face_m(std::size_t axis, std::int32_t index) const noexcept {
    return static_cast<double>(2 * index - static_cast<std::int32_t>(cells[axis])) * half_cell_m;
  }
  [[nodiscard]] bool is_inside(Cell cell) const noexcept {
    return static_cast<std::uint32_t>(cell.x) < cells[0] &&
           static_cast<std::uint32_t>(cell.y) < cells[1] &&
           static_cast<std::uint32_t>(cell.z) < cells[2];
  }
  // `p` moved into the box of the world widened by one cell on every side, component by
  // component: near enough to compute with, beyond every face that `p` is beyond.
  [[nodiscard]] Position3 clamp_near(Position3 p) const noexcept {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double edge_m = face_m(axis, static_cast<std::int32_t>(cells[axis]) + 1);
      p[axis] = std::clamp(p[axis], -edge_m, edge_m);
    }
    return p;
  }
  bool operator==(const CellLattice&) const = default;
};

}  // namespace thimble::world
