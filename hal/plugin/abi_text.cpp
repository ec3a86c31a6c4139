#include "hal/plugin/abi_text.hpp"

#include <array>
#include <cstdint>

namespace thimble::plugin {
namespace {

struct Character {
  std::uint32_t code{0};
  std::size_t bytes{0};  // 0: no UTF-8
};

std::size_t length_from(std::uint32_t first) noexcept {
  if (first < 0x80) return 1;
  if (first >= 0xC0 && first < 0xE0) return 2;
  if (first >= 0xE0 && first < 0xF0) return 3;
  return first >= 0xF0 && first < 0xF8 ? 4 : 0;
}

// RFC 3629: the shortest form only, no halves of UTF-16 pairs, nothing beyond U+10FFFF.
bool is_allowed(const Character& character) noexcept {
  constexpr std::array<std::uint32_t, 5> kSmallest{0, 0, 0x80, 0x800, 0x10000};
  const bool is_half_pair = character.code >= 0xD800 && character.code <= 0xDFFF;
  return character.code >= kSmallest[character.bytes] && character.code <= 0x10FFFF &&
         !is_half_pair;
}

Character first_of(std::string_view text) noexcept {
  const std::uint32_t first = static_cast<unsigned char>(text[0]);
  const std::size_t bytes = length_from(first);
  if (bytes == 0 || bytes > text.size()) return {};
  Character character{bytes == 1 ? first : first & (0x7FU >> bytes), bytes};
  for (const char c : text.substr(1, bytes - 1)) {
    const std::uint32_t next = static_cast<unsigned char>(c);
    if ((next & 0xC0U) != 0x80) return {};
    character.code = character.code << 6U | (next & 0x3FU);
  }
  return is_allowed(character) ? character : Character{};
}

bool is_control(std::uint32_t code) noexcept {
  return code < 0x20 || (code >= 0x7F && code <= 0x9F);
}

}  // namespace

std::string plain_utf8(std::string_view text) {
  std::string plain;
  while (!text.empty()) {
    const Character character = first_of(text);
    const std::size_t taken = std::max<std::size_t>(character.bytes, 1);
    if (character.bytes == 0 || is_control(character.code)) {
      plain += '?';
    } else {
      plain += text.substr(0, taken);
    }
    text.remove_prefix(taken);
  }
  return plain;
}

}  // namespace thimble::plugin
