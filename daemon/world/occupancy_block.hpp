#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "daemon/world/cell.hpp"
#include "hal/rt/static_vector.hpp"

namespace thimble::world {

// Ours: 8 cells an edge, so that a slice is a word, and a block of 64 bytes goes beside planes into
// one datagram.
inline constexpr std::int32_t kBlockEdge_cells = 8;
inline constexpr std::size_t kBlockSlices = 8;

// Which cells of a cube of them are occupied, and how new that is. Cells beyond the grid count as
// occupied. A value: it crosses threads by copying.
struct OccupancyBlock {
  std::array<std::int16_t, 3> at{};  // in blocks: cell / 8, along x, y, z
  // Of one session: of two tellings of the same place the one with the higher number is newer. From
  // 1.
  std::uint32_t version{0};
  std::array<std::uint64_t, kBlockSlices> slices{};  // bit x + 8·y of slice z

  bool operator==(const OccupancyBlock&) const = default;
};

// Of a cell that is in a grid, whose numbers are 0 at least: unsigned division is a shift.
[[nodiscard]] constexpr std::array<std::int16_t, 3> block_of(Cell cell) noexcept {
  constexpr auto kEdge = static_cast<std::uint32_t>(kBlockEdge_cells);
  return {static_cast<std::int16_t>(static_cast<std::uint32_t>(cell.x) / kEdge),
          static_cast<std::int16_t>(static_cast<std::uint32_t>(cell.y) / kEdge),
          static_cast<std::int16_t>(static_cast<std::uint32_t>(cell.z) / kEdge)};
}

// What one answer tells. Ours: 512 blocks are told in 128 answers, and an answer still fits into a
// datagram.
inline constexpr std::size_t kMostBlocksTold = 4;
using ToldBlocks = rt::StaticVector<OccupancyBlock, kMostBlocksTold>;

// Ours: 64 cells an edge, the largest world of the thesis in space (4.3), are known as a whole; of
// a larger one those around the hand. The slot of a place is the remainder of its three numbers, so
// that a window of 8 blocks an edge has a slot for each, wherever it is.
inline constexpr std::size_t kWindowEdge_blocks = 8;
inline constexpr std::size_t kMirrorSlots =
    kWindowEdge_blocks * kWindowEdge_blocks * kWindowEdge_blocks;
[[nodiscard]] constexpr std::size_t slot_of(const std::array<std::int16_t, 3>& at) noexcept {
  std::size_t slot = 0;
  for (std::size_t axis = 3; axis-- > 0;) {
    const auto place = static_cast<std::size_t>(static_cast<std::uint16_t>(at[axis]));
    slot = slot * kWindowEdge_blocks + place % kWindowEdge_blocks;
  }
  return slot;
}

}  // namespace thimble::world
