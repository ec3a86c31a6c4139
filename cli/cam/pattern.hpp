#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/result.hpp"

namespace thimble::cam {

// Cells that are set or not, along x, y, z; x runs fastest.
struct Pattern {
  std::array<std::size_t, 3> size{0, 0, 1};
  std::vector<bool> cells{};

  [[nodiscard]] std::size_t index_of(std::size_t x, std::size_t y, std::size_t z) const noexcept {
    return x + size[0] * (y + size[1] * z);
  }
};

// Ours: 32 MiB of bits, as many as the largest space has of 2^14 x 2^14 cells.
inline constexpr std::size_t kMaxPatternCells = std::size_t{1} << 28;
inline constexpr std::size_t kMaxPatternBytes = std::size_t{64} << 20;

// Golly's and others' run-length encoding: comments, `x = …, y = …`, then runs of b or . (not set)
// and any other state (set), $ for the end of a row, ! for that of the pattern. The rule is not
// looked at. Pure and total. Errors: Malformed, TooLarge.
// SOURCE: "Golly File Formats" and LifeWiki, "Run Length Encoded".
[[nodiscard]] Result<Pattern> parse_rle(std::string_view text);
// Of the plane z = 0.
[[nodiscard]] std::string to_rle(const Pattern& pattern, std::string_view rule);

// Reads a pattern by the end of its file's name: .rle, .npy, .nrrd or .nhdr (whose numbers above 0
// are set, at most 1024 along an axis). Errors: one sentence that begins with the path.
[[nodiscard]] Result<Pattern> read_pattern(const std::string& file);

}  // namespace thimble::cam
