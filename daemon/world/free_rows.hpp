#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "daemon/world/cell.hpp"
#include "daemon/world/voxel_grid.hpp"
#include "hal/base/geometry.hpp"

namespace thimble::world {

// Which rows of a grid have a free cell, so that a search for one looks into no row in vain:
// whoever opens session after session into a large world with hardly a free cell costs its thread
// next to nothing, and no search has to find out what edits have filled.
//
// Thread: one, the world's. Not RT; nearest() and note_changed() neither allocate nor block.
class FreeRows {
 public:
  // Walks the grid once, as whoever made it did.
  explicit FreeRows(const VoxelGrid& grid);

  // Cells of this row were freed or filled. Looks at the words of that row, as the edit did.
  void note_changed(const VoxelGrid& grid, Cell row) noexcept;
  // The free cell whose closed box is nearest to `p`; of equally near ones the first by z, y and x.
  // `grid` is the one that it was made of, with what was changed since then noted; `p` finite.
  //
  // Looks at layers, and into the rows of them that have a free cell, from `p` outwards until
  // nothing nearer can come: each at most once, and none that is full.
  [[nodiscard]] std::optional<Cell> nearest(const VoxelGrid& grid, Position3 p) noexcept;
  // Layers that the searches have looked at so far, and cells of the rows looked into.
  [[nodiscard]] std::uint64_t looked_at() const noexcept { return looked_at_; }

 private:
  struct Best;
  void search_layer(const VoxelGrid& grid, Position3 p, std::int32_t z, double dz2_m2,
                    Best& best) noexcept;
  void search_row(const VoxelGrid& grid, Position3 p, Cell row, double row2_m2,
                  Best& best) noexcept;
  [[nodiscard]] std::span<std::uint64_t> layer(std::int32_t z) noexcept;

  std::size_t rows_;                     // of a layer
  std::size_t words_;                    // that hold a layer's rows, a bit each
  std::vector<std::uint64_t> has_free_;  // layer after layer
  std::vector<std::uint32_t> counts_;    // by layer: rows that have
  std::uint64_t looked_at_{0};
};

}  // namespace thimble::world
