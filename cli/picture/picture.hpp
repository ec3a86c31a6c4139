#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/model/cam/engine/engine.hpp"

namespace thimble::picture {

// Cells along x, y, z; x runs fastest. A color is three bits, red, green and blue from bit 0 on; 0:
// nothing is there.
struct ColorVolume {
  std::array<std::size_t, 3> cells{};
  std::vector<std::uint8_t> colors{};
};

// Rows from the top; three bytes a pixel, red first.
struct Picture {
  std::size_t width{0};
  std::size_t height{0};
  std::vector<std::uint8_t> rgb{};
  bool operator==(const Picture&) const = default;
};

// The CAM's renderer of slices (its manual's key map aside: thesis 4.2.3) with three bits of color
// and shadows, as a program of a CAM: the picture is a plane of sites, and the volume is swept
// through it slice by slice from the viewer away, who looks along -z with y up. Light comes over
// the viewer's left shoulder and goes a cell right, down and away with each slice; each cell that
// it passes halves it. Behind the last slice is a wall.
namespace site {
inline constexpr int kMatterBit = 0;  // to 2: color of the slice's cell
inline constexpr int kSeenBit = 3;    // to 5: of the first cell that was met, 0 for none yet
inline constexpr int kLightBit = 6;   // to 8: cells that the light has passed here, at most 7
inline constexpr int kShadeBit = 9;   // to 11: the same where the seen cell is
}  // namespace site
// What a slice makes of a site. Pure.
[[nodiscard]] std::uint32_t render_rule(std::uint32_t site) noexcept;

// Each cell is `pixels` wide, at least 1. `volume` as it says, at most 2^20 cells, 1024 along x and
// y.
[[nodiscard]] Picture render(const ColorVolume& volume, std::size_t pixels);

// A color in a shade, and the wall (color 0) likewise: red, green, blue.
[[nodiscard]] std::array<std::uint8_t, 3> pixel_of(std::uint32_t color,
                                                   std::uint32_t shade) noexcept;

// Portable Network Graphics, 8 bits a channel (RFC 2083).
[[nodiscard]] std::string to_png(const Picture& picture);

}  // namespace thimble::picture
