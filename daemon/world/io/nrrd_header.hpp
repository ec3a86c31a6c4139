#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "daemon/world/io/volume_items.hpp"
#include "hal/base/result.hpp"

namespace thimble::world {

// Source of the format: "Definition of NRRD File Format", teem.sourceforge.net/nrrd/format.html
// (Teem 1.9 and later), magics NRRD0001 to NRRD0005.

enum class NrrdEncoding : std::uint8_t { Raw, Gzip, Text };

// What the header of an NRRD file says of the volume behind it.
struct NrrdHeader {
  ItemType type{};
  NrrdEncoding encoding{};
  std::array<std::uint32_t, 3> sizes{};            // fastest axis first, each 1…1024
  std::optional<std::array<double, 3>> spacing{};  // of the same axes, > 0; none: not said
  bool has_axis_bounds{false};                     // axis mins or maxs: spacing said otherwise
  std::uint32_t line_skip{0};
  std::int64_t byte_skip{0};    // -1: as many as leave the data's own at the end
  std::string data_file{};      // within the header's folder; empty: behind the header
  std::size_t header_bytes{0};  // with the blank line that ends it
};

// Ours: what a header may take, comments and key/value pairs included.
inline constexpr std::size_t kNrrdMaxHeaderBytes = 65536;
inline constexpr std::uint32_t kNrrdMaxLineSkip = 1000000;
inline constexpr std::int64_t kNrrdMaxByteSkip = std::int64_t{1} << 40;

// Parses the header that `text` starts with. `is_all` when no more of the file follows: then a
// header of a detached file may end there, without its blank line.
//
// Pure and total; any bytes give a value or an error that names the field. Malformed: not the
// format; TooLarge: beyond a stated limit; Unsupported: valid, but not one grid of plain numbers
// in raw, gzip or text encoding.
[[nodiscard]] Result<NrrdHeader> parse_nrrd_header(std::string_view text, bool is_all);

}  // namespace thimble::world
