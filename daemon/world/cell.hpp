#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace thimble::world {

// Index of a cubic cell of a grid along x, y and z; may lie outside the grid.
struct Cell {
  std::int32_t x{0}, y{0}, z{0};

  constexpr std::int32_t operator[](std::size_t axis) const noexcept {
    return axis == 0 ? x : axis == 1 ? y : z;
  }
  constexpr std::int32_t& operator[](std::size_t axis) noexcept {
    return axis == 0 ? x : axis == 1 ? y : z;
  }
  constexpr bool operator==(const Cell&) const = default;
};

}  // namespace thimble::world
