#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "daemon/world/cell.hpp"
#include "daemon/world/cell_lattice.hpp"
#include "hal/base/geometry.hpp"
#include "hal/base/result.hpp"

namespace thimble::world {

// Occupancy of a box of cubic cells, one bit each, centred on the world's origin. Everything
// outside is occupied: the world has walls.
//
// Thread: one at a time. RT: reading is THIMBLE_RT; create() allocates.
// Units, frame: m, world frame; a point on a face (CellLattice) belongs to neither cell more than
// to the other.
class VoxelGrid {
 public:
  // Ours: 1024^3 bits are 128 MiB. The thesis's worlds had 64^3 and 512 x 512 x 1 cells (4.3).
  static constexpr std::uint32_t kMaxCellsPerAxis = 1024;

  // All cells free. InvalidArgument unless every axis has 1…kMaxCellsPerAxis cells and
  // 1e-9 <= cell_m <= 1e3.
  [[nodiscard]] static Result<VoxelGrid> create(std::array<std::uint32_t, 3> cells, double cell_m);
  // What create() would say, without its memory.
  [[nodiscard]] static Result<void> check(std::array<std::uint32_t, 3> cells, double cell_m);
  // The same in a word, without an allocation. RT: THIMBLE_RT.
  [[nodiscard]] static bool is_possible(const CellLattice& lattice) noexcept {
    return std::all_of(lattice.cells.begin(), lattice.cells.end(), is_count) &&
           is_edge(2 * lattice.half_cell_m);
  }

  [[nodiscard]] const CellLattice& lattice() const noexcept { return lattice_; }
  [[nodiscard]] const std::array<std::uint32_t, 3>& cells() const noexcept {
    return lattice_.cells;
  }
  [[nodiscard]] double cell_m() const noexcept { return 2 * lattice_.half_cell_m; }
  [[nodiscard]] double face_m(std::size_t axis, std::int32_t index) const noexcept {
    return lattice_.face_m(axis, index);
  }
  [[nodiscard]] bool is_inside(Cell cell) const noexcept { return lattice_.is_inside(cell); }
  [[nodiscard]] bool is_occupied(Cell cell) const noexcept {
    if (!is_inside(cell)) return true;
    const std::size_t bit = bit_of(cell);
    return ((words_[bit / 64] >> (bit % 64)) & 1U) != 0;
  }
  void fill() noexcept;  // every cell occupied
  // A cell outside the grid is left alone.
  void set_occupied(Cell cell, bool is_occupied) noexcept;

  // The cells of one row from `from` up to, not including, x = `end_x`, cut to the grid. Returns
  // how many were not so before.
  std::size_t set_row(Cell from, std::int32_t end_x, bool is_occupied) noexcept;
  [[nodiscard]] std::size_t count_occupied() const noexcept;
  // Cell x + X (y + Y z) is bit n % 64 of word n / 64 for n its number; bits behind the last cell
  // mean nothing.
  [[nodiscard]] std::span<const std::uint64_t> words() const noexcept { return words_; }
  // The number of a cell that is in the grid.
  [[nodiscard]] std::size_t bit_of(Cell cell) const noexcept {
    return static_cast<std::size_t>(cell.x) +
           cells()[0] *
               (static_cast<std::size_t>(cell.y) + cells()[1] * static_cast<std::size_t>(cell.z));
  }
  // Word `index`, which must be there; its bits are as words() has them. Not RT.
  void set_word(std::size_t index, std::uint64_t word) noexcept {
    if (words_[index] == word) return;
    words_[index] = word;
    ++revision_;
  }
  // Grows whenever words() may have changed: who saw it before knows that they have not. A copy has
  // that of its origin.
  [[nodiscard]] std::uint64_t revision() const noexcept { return revision_; }

  // Of the `count` cells of one row from `from` up, 1 to 64, all of them in the grid: bit i is the
  // i-th.
  [[nodiscard]] std::uint64_t bits_in_row(Cell from, std::size_t count) const noexcept;
  // The first free cell at or after `from.x` in the row of `from`; x = cells()[0] when none.
  [[nodiscard]] std::int32_t next_free_in_row(Cell from) const noexcept;
  [[nodiscard]] Position3 clamp_near(Position3 p) const noexcept { return lattice_.clamp_near(p); }
  // The index of the one cell whose closed interval holds `p`, or of the lower of two when `p`
  // is on a face; limited to the grid. `p` finite.
  [[nodiscard]] std::int32_t lower_index(std::size_t axis, double p) const noexcept;
  // The upper of two: lower_index() mirrored.
  [[nodiscard]] std::int32_t upper_index(std::size_t axis, double p) const noexcept {
    return static_cast<std::int32_t>(cells()[axis]) - 1 - lower_index(axis, -p);
  }
  [[nodiscard]] std::size_t memory_bytes() const noexcept { return words_.size() * 8; }
  // Of the cells; how often they were changed does not count.
  bool operator==(const VoxelGrid& other) const noexcept {
    return lattice_ == other.lattice_ && words_ == other.words_;
  }

 private:
  VoxelGrid(std::array<std::uint32_t, 3> cells, double cell_m);
  [[nodiscard]] static constexpr bool is_count(std::uint32_t cells) noexcept {
    return cells >= 1 && cells <= kMaxCellsPerAxis;
  }
  [[nodiscard]] static constexpr bool is_edge(double cell_m) noexcept {
    return cell_m >= 1e-9 && cell_m <= 1e3;
  }

  CellLattice lattice_;
  std::vector<std::uint64_t> words_;
  std::uint64_t revision_{0};
};

// The thesis's workspace, a cube of 90 mm (thesis 4.1; app. A and B: 3 cells of 30 mm).
inline constexpr double kDefaultWorkspace_m = 0.090;

// The hollow box of the thesis, "Hello, voxel!", cut into `cells` cells a side: free are the
// cells whose centre lies in the middle third of every axis. 3 cells: all but the centre occupied.
// InvalidArgument unless 3 <= cells <= 1024 and the workspace is usable.
[[nodiscard]] Result<VoxelGrid> make_box(std::uint32_t cells,
                                         double workspace_m = kDefaultWorkspace_m);
// What make_box() would say, without its memory.
[[nodiscard]] Result<void> check_box(std::uint32_t cells, double workspace_m);

}  // namespace thimble::world
