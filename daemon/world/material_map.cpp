#include "daemon/world/material_map.hpp"

#include <algorithm>
#include <string>

namespace thimble::world {

Result<MaterialMap> MaterialMap::create(std::array<std::uint32_t, 3> cells,
                                        const std::vector<Material>& materials) {
  if (materials.size() > kMaxMaterials) {
    return fail(Errc::TooLarge, "materials: " + std::to_string(materials.size()) +
                                    "; the limit is " + std::to_string(kMaxMaterials));
  }
  MaterialMap map;
  if (materials.empty()) return map;
  map.cells_ = cells;
  map.bits_ = materials.size() <= 1 ? 1 : materials.size() <= 3 ? 2 : 4;
  map.materials_.insert(map.materials_.end(), materials.begin(), materials.end());
  const std::size_t count = std::size_t{cells[0]} * cells[1] * cells[2];
  map.words_.resize((count * map.bits_ + 63) / 64);
  return map;
}

bool MaterialMap::is_inside(Cell cell) const noexcept {
  return static_cast<std::uint32_t>(cell.x) < cells_[0] &&
         static_cast<std::uint32_t>(cell.y) < cells_[1] &&
         static_cast<std::uint32_t>(cell.z) < cells_[2];
}

std::size_t MaterialMap::index_of(Cell cell) const noexcept {
  const std::size_t row =
      static_cast<std::size_t>(cell.y) + std::size_t{cells_[1]} * static_cast<std::size_t>(cell.z);
  return static_cast<std::size_t>(cell.x) + cells_[0] * row;
}

std::size_t MaterialMap::label(Cell cell) const noexcept {
  if (!is_inside(cell)) return 0;
  const std::size_t bit = index_of(cell) * bits_;
  return (words_[bit / 64] >> (bit % 64)) & ((1U << bits_) - 1);
}

void MaterialMap::set(Cell cell, std::uint8_t label) noexcept {
  if (!is_inside(cell) || label >= materials_.size()) return;
  const std::size_t bit = index_of(cell) * bits_;
  const std::uint64_t mask = ((std::uint64_t{1} << bits_) - 1) << (bit % 64);
  std::uint64_t& word = words_[bit / 64];
  word = (word & ~mask) | (std::uint64_t{label} << (bit % 64));
}

void MaterialMap::set_row(Cell from, std::int32_t end_x, std::uint8_t label) noexcept {
  from.x = std::max(from.x, 0);
  const std::int32_t end = std::min(end_x, static_cast<std::int32_t>(cells_[0]));
  if (!is_inside(from) || from.x >= end || label >= materials_.size()) return;
  std::uint64_t pattern = label;
  for (unsigned width = bits_; width < 64; width *= 2) pattern |= pattern << width;
  std::size_t bit = index_of(from) * bits_;
  for (std::size_t left = static_cast<std::size_t>(end - from.x) * bits_; left > 0;) {
    const std::size_t count = std::min(left, 64 - bit % 64);
    const std::uint64_t mask = (~std::uint64_t{0} >> (64 - count)) << (bit % 64);
    std::uint64_t& word = words_[bit / 64];
    word = (word & ~mask) | (pattern & mask);
    bit += count;
    left -= count;
  }
}

}  // namespace thimble::world
