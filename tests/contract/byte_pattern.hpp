#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace thimble::test {

// Bytes that show where they were cut, doubled or moved: each differs from its neighbours.
inline std::vector<std::uint8_t> pattern(std::size_t size, unsigned seed) {
  std::vector<std::uint8_t> bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::uint8_t>(seed + 7 * i);
  return bytes;
}

}  // namespace thimble::test
