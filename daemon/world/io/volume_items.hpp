#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace thimble::world {

enum class ItemKind : std::uint8_t { Bool, Signed, Unsigned, Float };

// How a file stores one number of its volume.
struct ItemType {
  ItemKind kind{};
  std::uint32_t bytes{0};     // 1, 2, 4 or 8; floats 2, 4 or 8
  bool is_big_endian{false};  // meaningless for single bytes
  bool operator==(const ItemType&) const = default;
};

// The numbers of `raw`, one after another; raw.size() == type.bytes * out.size(). Integers beyond
// 2^53 are rounded to the nearest double. Halves are IEEE 754 binary16.
void decode_items(std::span<const std::byte> raw, ItemType type, std::span<double> out) noexcept;

}  // namespace thimble::world
