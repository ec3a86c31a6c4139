#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thimble::link {

// Programs of 1999 at either end, written from the description of the protocol and sharing no
// code with the codec.
namespace y1999 {

using Datagram = std::vector<std::byte>;

inline void put_word(Datagram& out, std::uint32_t word) {
  for (int shift = 24; shift >= 0; shift -= 8) {
    out.push_back(static_cast<std::byte>((word >> static_cast<unsigned>(shift)) & 0xFFU));
  }
}

inline float get_float(std::span<const std::byte> in, std::size_t at) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 4; ++i)
    word = word * 256 + std::to_integer<std::uint32_t>(in[at + i]);
  return std::bit_cast<float>(word);
}

inline Datagram request(float x_mm, float y_mm, float z_mm) {
  Datagram out;
  for (const float value : {x_mm, y_mm, z_mm}) put_word(out, std::bit_cast<std::uint32_t>(value));
  return out;
}

// Three cells a side; the ghost never leaves the middle one. Axes without a direction keep
// whatever was in the buffer, as in the original: here a pattern that changes with each reply
// and runs through NaN, infinities and huge numbers.
class Server {
 public:
  // Empty: malformed, the server prints a line and goes on waiting.
  Datagram answer(std::span<const std::byte> in) {
    if (in.size() != 12) return {};
    Datagram out;
    unsigned directions = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      int cell = static_cast<int>((get_float(in, 4 * axis) + 45.0F) / 30.0F);
      cell = cell < 0 ? 0 : cell > 2 ? 2 : cell;
      const bool is_less = cell > 1;
      const bool is_greater = cell < 1;
      if (is_less) directions |= 1U << (2 * axis);
      if (is_greater) directions |= 2U << (2 * axis);
      const float plane = is_less ? 15.0F : -15.0F;
      const bool is_set = is_less || is_greater;
      put_word(out, is_set ? std::bit_cast<std::uint32_t>(plane) : garbage());
    }
    out.push_back(static_cast<std::byte>(directions));
    return out;
  }

 private:
  std::uint32_t garbage() {
    constexpr std::array<std::uint32_t, 6> kPatterns{0x7FC00000, 0x7F800000, 0xFF800000,
                                                     0x7F7FFFFF, 0xDEADBEEF, 0xFFFFFFFF};
    return kPatterns[next_++ % kPatterns.size()];
  }
  std::size_t next_{0};
};

}  // namespace y1999
}  // namespace thimble::link
