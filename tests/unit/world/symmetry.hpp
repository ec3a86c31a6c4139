#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "tests/unit/world/grids.hpp"

namespace thimble::world {

// One of the 48 ways to exchange and mirror axes: image[to[a]] = sign[a] * original[a].
struct Symmetry {
  std::array<std::size_t, 3> to{0, 1, 2};
  std::array<bool, 3> is_mirrored{};

  [[nodiscard]] bool exchanges_axes() const { return to != std::array<std::size_t, 3>{0, 1, 2}; }
};

inline std::vector<Symmetry> all_symmetries() {
  std::vector<Symmetry> all;
  std::array<std::size_t, 3> to{0, 1, 2};
  do {
    for (unsigned m = 0; m < 8; ++m)
      all.push_back({to, {(m & 1) != 0, (m & 2) != 0, (m & 4) != 0}});
  } while (std::next_permutation(to.begin(), to.end()));
  return all;
}

template <class Vector>
Vector image(const Symmetry& s, const Vector& v) {
  Vector out;
  for (std::size_t a = 0; a < 3; ++a) out[s.to[a]] = s.is_mirrored[a] ? -v[a] : v[a];
  return out;
}

// What `v` is the image of.
template <class Vector>
Vector original(const Symmetry& s, const Vector& v) {
  Vector out;
  for (std::size_t a = 0; a < 3; ++a) out[a] = s.is_mirrored[a] ? -v[s.to[a]] : v[s.to[a]];
  return out;
}

inline Cell image(const Symmetry& s, const VoxelGrid& grid, Cell c) {
  Cell out;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto last = static_cast<std::int32_t>(grid.cells()[a]) - 1;
    out[s.to[a]] = s.is_mirrored[a] ? last - c[a] : c[a];
  }
  return out;
}

inline VoxelGrid image(const Symmetry& s, const VoxelGrid& grid) {
  std::array<std::uint32_t, 3> cells{};
  for (std::size_t a = 0; a < 3; ++a) cells[s.to[a]] = grid.cells()[a];
  VoxelGrid out = empty_grid(cells, grid.cell_m());
  for_each_cell(grid, [&](Cell c) { out.set_occupied(image(s, grid, c), grid.is_occupied(c)); });
  return out;
}

}  // namespace thimble::world
