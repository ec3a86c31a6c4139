#include "daemon/world/io/volume_items.hpp"

#include <bit>
#include <cmath>
#include <cstring>

namespace thimble::world {
namespace {

// 1 sign, 5 exponent (bias 15), 10 fraction bits.
[[nodiscard]] double half_to_double(std::uint16_t bits) noexcept {
  const int exponent = (bits >> 10) & 0x1F;
  const int fraction = bits & 0x3FF;
  double value = 0;
  if (exponent == 0x1F) {
    value = fraction == 0 ? HUGE_VAL : std::nan("");
  } else if (exponent == 0) {
    value = std::ldexp(fraction, -24);
  } else {
    value = std::ldexp(fraction + 1024, exponent - 25);
  }
  return (bits & 0x8000) != 0 ? -value : value;
}

template <class Unsigned>
[[nodiscard]] Unsigned reversed(Unsigned value) noexcept {
  Unsigned out = 0;
  for (std::size_t i = 0; i < sizeof value; ++i) {
    out = static_cast<Unsigned>((out << 7 << 1) | ((value >> (8 * i)) & 0xFF));
  }
  return out;
}

// One loop for each width and meaning: a volume of 1024^3 items passes through here.
template <class Unsigned, class Convert>
void decode_each(std::span<const std::byte> raw, bool is_swapped, std::span<double> out,
                 Convert convert) noexcept {
  for (std::size_t i = 0; i < out.size(); ++i) {
    Unsigned bits = 0;
    std::memcpy(&bits, raw.data() + i * sizeof bits, sizeof bits);
    out[i] = convert(is_swapped ? reversed(bits) : bits);
  }
}

template <class Unsigned, class Signed>
void decode_integers(std::span<const std::byte> raw, ItemType type, bool is_swapped,
                     std::span<double> out) noexcept {
  if (type.kind == ItemKind::Signed) {
    return decode_each<Unsigned>(raw, is_swapped, out, [](Unsigned bits) noexcept {
      return static_cast<double>(std::bit_cast<Signed>(bits));
    });
  }
  decode_each<Unsigned>(raw, is_swapped, out,
                        [](Unsigned bits) noexcept { return static_cast<double>(bits); });
}

void decode_floats(std::span<const std::byte> raw, ItemType type, bool is_swapped,
                   std::span<double> out) noexcept {
  if (type.bytes == 2) return decode_each<std::uint16_t>(raw, is_swapped, out, half_to_double);
  if (type.bytes == 4) {
    return decode_each<std::uint32_t>(raw, is_swapped, out, [](std::uint32_t bits) noexcept {
      return static_cast<double>(std::bit_cast<float>(bits));
    });
  }
  decode_each<std::uint64_t>(raw, is_swapped, out, [](std::uint64_t bits) noexcept {
    return std::bit_cast<double>(bits);
  });
}

}  // namespace

void decode_items(std::span<const std::byte> raw, ItemType type, std::span<double> out) noexcept {
  const bool is_swapped = type.is_big_endian != (std::endian::native == std::endian::big);
  if (type.kind == ItemKind::Float) return decode_floats(raw, type, is_swapped, out);
  if (type.kind == ItemKind::Bool) {
    return decode_each<std::uint8_t>(
        raw, false, out, [](std::uint8_t bits) noexcept { return bits != 0 ? 1.0 : 0.0; });
  }
  switch (type.bytes) {
    case 1:
      return decode_integers<std::uint8_t, std::int8_t>(raw, type, is_swapped, out);
    case 2:
      return decode_integers<std::uint16_t, std::int16_t>(raw, type, is_swapped, out);
    case 4:
      return decode_integers<std::uint32_t, std::int32_t>(raw, type, is_swapped, out);
    default:
      return decode_integers<std::uint64_t, std::int64_t>(raw, type, is_swapped, out);
  }
}

}  // namespace thimble::world
