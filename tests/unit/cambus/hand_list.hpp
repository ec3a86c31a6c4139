#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thimble::cambus::test {

// A window's bytes, and the words that a board sees them as.
class HandWindow {
 public:
  explicit HandWindow(std::size_t bytes) : words_((bytes + 3) / 4) {}
  [[nodiscard]] std::span<std::uint8_t> bytes() {
    return {reinterpret_cast<std::uint8_t*>(words_.data()), 4 * words_.size()};
  }
  [[nodiscard]] std::span<std::uint32_t> words() { return words_; }

 private:
  std::vector<std::uint32_t> words_;
};

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
