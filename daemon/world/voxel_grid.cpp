#include "daemon/world/voxel_grid.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

namespace thimble::world {

VoxelGrid::VoxelGrid(std::array<std::uint32_t, 3> cells, double cell_m)
    : lattice_{cells, cell_m / 2},
      words_((static_cast<std::size_t>(cells[0]) * cells[1] * cells[2] + 63) / 64, 0) {}

Result<void> VoxelGrid::check(std::array<std::uint32_t, 3> cells, double cell_m) {
  for (const std::uint32_t count : cells) {
    if (!is_count(count)) {
      return fail(Errc::InvalidArgument, "cells per axis: " + std::to_string(count) +
                                             " is not within 1 to " +
                                             std::to_string(kMaxCellsPerAxis));
    }
  }
  if (!is_edge(cell_m)) {
    return fail(Errc::InvalidArgument,
                "cell size: " + std::to_string(cell_m) + " m is not within 1e-9 to 1e3 m");
  }
  return {};
}

Result<VoxelGrid> VoxelGrid::create(std::array<std::uint32_t, 3> cells, double cell_m) {
  if (const auto checked = check(cells, cell_m); !checked) return tl::unexpected(checked.error());
  return VoxelGrid(cells, cell_m);
}

void VoxelGrid::fill() noexcept {
  std::fill(words_.begin(), words_.end(), ~std::uint64_t{0});
  ++revision_;
}

void VoxelGrid::set_occupied(Cell cell, bool is_occupied) noexcept {
  if (!is_inside(cell)) return;
  const std::size_t bit = bit_of(cell);
  const std::uint64_t mask = std::uint64_t{1} << (bit % 64);
  const std::uint64_t word = words_[bit / 64];
  set_word(bit / 64, is_occupied ? word | mask : word & ~mask);
}

std::size_t VoxelGrid::set_row(Cell from, std::int32_t end_x, bool is_occupied) noexcept {
  from.x = std::max(from.x, 0);
  const std::int32_t end = std::min(end_x, static_cast<std::int32_t>(lattice_.cells[0]));
  if (!is_inside(from) || from.x >= end) return 0;
  std::size_t changed = 0;
  std::size_t bit = bit_of(from);
  for (auto left = static_cast<std::size_t>(end - from.x); left > 0;) {
    const std::size_t count = std::min(left, 64 - bit % 64);
    const std::uint64_t mask = (~std::uint64_t{0} >> (64 - count)) << (bit % 64);
    const std::uint64_t word = words_[bit / 64];
    const std::uint64_t after = is_occupied ? word | mask : word & ~mask;
    changed += static_cast<std::size_t>(std::popcount(word ^ after));
    set_word(bit / 64, after);
    bit += count;
    left -= count;
  }
  return changed;
}

std::size_t VoxelGrid::count_occupied() const noexcept {
  const std::size_t cells =
      static_cast<std::size_t>(lattice_.cells[0]) * lattice_.cells[1] * lattice_.cells[2];
  std::size_t count = 0;
  for (const std::uint64_t word : words_) count += static_cast<std::size_t>(std::popcount(word));
  if (cells % 64 == 0) return count;
  // fill() sets the unused bits of the last word, too.
  return count - static_cast<std::size_t>(std::popcount(words_.back() >> (cells % 64)));
}

std::int32_t VoxelGrid::next_free_in_row(Cell from) const noexcept {
  const auto end = static_cast<std::int32_t>(lattice_.cells[0]);
  Cell cell = from;
  while (cell.x < end) {
    const std::size_t bit = bit_of(cell);
    const std::uint64_t free = ~words_[bit / 64] >> (bit % 64);
    if (free != 0) return std::min(end, cell.x + std::countr_zero(free));
    cell.x += static_cast<std::int32_t>(64 - bit % 64);
  }
  return end;
}

std::uint64_t VoxelGrid::bits_in_row(Cell from, std::size_t count) const noexcept {
  const std::size_t bit = bit_of(from);
  const std::size_t shift = bit % 64;
  std::uint64_t bits = words_[bit / 64] >> shift;
  if (shift + count > 64) bits |= words_[bit / 64 + 1] << (64 - shift);
  return bits & (~std::uint64_t{0} >> (64 - count));
}

std::int32_t VoxelGrid::lower_index(std::size_t axis, double p) const noexcept {
  const auto last = static_cast<std::int32_t>(lattice_.cells[axis]) - 1;
  const double low = face_m(axis, 0);
  if (!(p > low)) return 0;
  if (p >= -low) return last;
  auto index = static_cast<std::int32_t>((p - low) / cell_m());
  index = std::clamp(index, 0, last);
  // The quotient is rounded; the faces decide.
  while (index > 0 && p <= face_m(axis, index)) --index;
  while (index < last && p > face_m(axis, index + 1)) ++index;
  return index;
}

Result<void> check_box(std::uint32_t cells, double workspace_m) {
  if (cells < 3 || cells > VoxelGrid::kMaxCellsPerAxis) {
    return fail(Errc::InvalidArgument, "box: " + std::to_string(cells) +
                                           " cells a side is not within 3 to " +
                                           std::to_string(VoxelGrid::kMaxCellsPerAxis));
  }
  return VoxelGrid::check({cells, cells, cells}, workspace_m / cells);
}

Result<VoxelGrid> make_box(std::uint32_t cells, double workspace_m) {
  if (const auto checked = check_box(cells, workspace_m); !checked) {
    return tl::unexpected(checked.error());
  }
  auto grid = VoxelGrid::create({cells, cells, cells}, workspace_m / cells);
  if (!grid) return grid;
  grid->fill();
  // |centre| < workspace / 6 in whole numbers; from both ends inwards the middle is symmetric.
  const auto count = static_cast<std::int32_t>(cells);
  std::int32_t first = 0;
  while (3 * (count - 2 * first - 1) >= count) ++first;
  const std::int32_t end = count - first;
  for (Cell cell{0, 0, first}; cell.z < end; ++cell.z) {
    for (cell.y = first; cell.y < end; ++cell.y) {
      for (cell.x = first; cell.x < end; ++cell.x) grid->set_occupied(cell, false);
    }
  }
  return grid;
}

}  // namespace thimble::world
