#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace thimble::cambus::test {

// Words of a window as docs/cambus.md, section 3, has them, written without the driver.
inline void put_word(std::span<std::uint8_t> window, std::uint32_t at, std::uint32_t value) {
  for (std::uint32_t i = 0; i < 4; ++i) {
    window[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
  }
}
inline void put_descriptor(std::span<std::uint8_t> window, std::uint32_t at, std::uint32_t opcode,
                           std::uint32_t buffer, std::uint32_t length, std::uint32_t link) {
  const std::array<std::uint32_t, 4> words{opcode, buffer, length, link};
  for (std::uint32_t i = 0; i < words.size(); ++i) put_word(window, at + 4 * i, words[i]);
}

}  // namespace thimble::cambus::test
