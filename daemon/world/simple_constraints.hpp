#pragma once

#include <array>
#include <cstdint>

#include "daemon/world/cell.hpp"
#include "daemon/world/voxel_grid.hpp"
#include "daemon/world/world.hpp"
#include "hal/base/geometry.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::world {

// What the simple constraint model (thesis 3.7.1, figure 3-8) knows of a hand: the cell that it is
// in, and on each axis at most one face that it has gone through. There is no ghost.
struct SimpleConstraints {
  Position3 hand{};  // not much outside the grid
  Cell cell{};       // of the hand; on a face the one it came from
  // Per axis: +1 / -1 while the hand is to come back below / above face `face`; 0: free.
  std::array<std::int8_t, 3> way{};
  std::array<std::int32_t, 3> face{};
  bool operator==(const SimpleConstraints&) const = default;
};

// For a hand that appears at `hand`: nothing holds it, wherever that is.
[[nodiscard]] THIMBLE_RT SimpleConstraints start_simple_constraints(const VoxelGrid& grid,
                                                                    Position3 hand) noexcept;

// Follows the hand straight to its new place, cell by cell. Going from a free cell into an occupied
// one sets a constraint on the axis of the face, unless that axis has one; a constraint ends when
// the hand is back in a cell on its admissible side, and in no other way. That is the model's
// fault, which the thesis describes and the ghost point mends. The ghost of the result is the hand.
//
// RT: THIMBLE_RT; bounded by the cells of one row, column and stack.
// Errors: none; a hand that is not finite leaves the state as it is and gives no planes.
THIMBLE_RT ProbeMotion constrain_simply(const VoxelGrid& grid, SimpleConstraints& state,
                                        Position3 hand) noexcept;

}  // namespace thimble::world
