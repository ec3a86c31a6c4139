#pragma once

#include <array>
#include <cstdint>

#include "daemon/world/cell.hpp"
#include "daemon/world/cell_lattice.hpp"
#include "daemon/world/occupancy_block.hpp"
#include "hal/base/geometry.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::world {

// What one who does not have the grid knows of it: the newest telling of each block that he was
// told of, 512 of them. Cells of other blocks count as free; ask is_known().
//
// Thread: one. RT: all but the constructor THIMBLE_RT. Size: 40 KiB.
// Errors: what cannot be is not learned.
class OccupancyMirror {
 public:
  // Knows nothing of a world of these cells; false, and the world has none, where they cannot be.
  THIMBLE_RT bool begin(const CellLattice& lattice) noexcept;
  // False: it is not of this world, or no newer than what is known.
  THIMBLE_RT bool learn(const OccupancyBlock& block) noexcept;

  [[nodiscard]] const CellLattice& lattice() const noexcept { return lattice_; }
  [[nodiscard]] THIMBLE_RT bool is_known(Cell cell) const noexcept;
  // Outside the world: occupied.
  [[nodiscard]] THIMBLE_RT bool is_occupied(Cell cell) const noexcept;
  [[nodiscard]] double face_m(std::size_t axis, std::int32_t index) const noexcept {
    return lattice_.face_m(axis, index);
  }
  [[nodiscard]] Position3 clamp_near(Position3 p) const noexcept { return lattice_.clamp_near(p); }

 private:
  [[nodiscard]] const OccupancyBlock* find(Cell cell) const noexcept;

  CellLattice lattice_{};
  std::array<OccupancyBlock, kMirrorSlots> slots_{};
};

}  // namespace thimble::world
