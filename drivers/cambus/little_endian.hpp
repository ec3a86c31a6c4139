#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace thimble::cambus {

// Words of 32 bits in a window, lowest byte first. Shorter spans are mistakes of the caller.
[[nodiscard]] inline std::uint32_t load32(std::span<const std::uint8_t> bytes) noexcept {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= std::uint32_t{bytes[i]} << (8 * i);
  return value;
}
inline void store32(std::span<std::uint8_t> bytes, std::uint32_t value) noexcept {
  for (std::size_t i = 0; i < 4; ++i) bytes[i] = static_cast<std::uint8_t>(value >> (8 * i));
}

}  // namespace thimble::cambus
