#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "daemon/world/cell.hpp"
#include "daemon/world/voxel_grid.hpp"
#include "hal/base/geometry.hpp"

namespace thimble::world {

// Which rows of a grid may have a free cell, so that a search for one looks at no row twice in
// vain: whoever opens session after session into a large world with hardly a free cell costs its
// thread next to nothing.
//
// Thread: one, the world's. Not RT; nearest() and note_freed() neither allocate nor block.
class FreeRows {
 public:
  // Walks the grid once.
  explicit FreeRows(const VoxelGrid& grid);

  // Cells of this row were freed. That they were filled need not be told.
  void note_freed(Cell row) noexcept;
  // The free cell whose closed box is nearest to `p`; of equally near ones the first by z, y and x.
  // `grid` is the one that it was made of, with what was freed since then noted; `p` finite.
  //
  // Looks at each layer and, in layers that may have a free cell, at each row, from `p` outwards
  // until nothing nearer can come; and into rows that have one, or had one the last time.
  [[nodiscard]] std::optional<Cell> nearest(const VoxelGrid& grid, Position3 p) noexcept;
  // Layers, rows and cells that the searches have looked at so far.
  [[nodiscard]] std::uint64_t looked_at() const noexcept { return looked_at_; }

 private:
  struct Best;
  void search_layer(const VoxelGrid& grid, Position3 p, std::int32_t z, double dz2_m2,
                    Best& best) noexcept;
  void search_row(const VoxelGrid& grid, Position3 p, Cell row, double row2_m2,
                  Best& best) noexcept;
  [[nodiscard]] std::size_t index_of(Cell row) const noexcept;

  std::size_t rows_;                   // of a layer
  std::vector<bool> may_have_free_;    // by row, layer after layer
  std::vector<std::uint32_t> counts_;  // by layer: rows that may
  std::uint64_t looked_at_{0};
};

}  // namespace thimble::world
