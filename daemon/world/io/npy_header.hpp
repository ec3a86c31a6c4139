#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "daemon/world/io/volume_items.hpp"
#include "hal/base/result.hpp"

namespace thimble::world {

// Source of the format: NumPy Enhancement Proposal 1 and the manual page "numpy.lib.format",
// versions 1.0, 2.0 and 3.0.

// What the header of a .npy file says of the array behind it.
struct NpyHeader {
  ItemKind kind{};
  std::uint32_t item_bytes{0};           // 1, 2, 4 or 8
  bool is_big_endian{false};             // meaningless for single bytes
  bool is_fortran_order{false};          // true: the first index runs fastest
  std::array<std::uint32_t, 3> shape{};  // each 1…1024
  bool operator==(const NpyHeader&) const = default;
};

// Magic, version and length of the header text: what must be read to know how much to read.
struct NpyPreamble {
  std::uint32_t preamble_bytes{0};  // 10 or 12
  std::uint32_t text_bytes{0};
};

inline constexpr std::size_t kNpyMaxPreambleBytes = 12;
// Ours, and the most that version 1.0 can say; a header of three dimensions has about 118 bytes.
inline constexpr std::uint32_t kNpyMaxTextBytes = 65535;

// Pure and total; any bytes give a value or an error that names the field. Malformed: not the
// format; TooLarge: beyond a stated limit; Unsupported: valid, but not a grid of plain numbers.
[[nodiscard]] Result<NpyPreamble> parse_npy_preamble(std::span<const std::byte> bytes);
[[nodiscard]] Result<NpyHeader> parse_npy_text(std::string_view text);

}  // namespace thimble::world
