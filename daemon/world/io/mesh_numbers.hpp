#pragma once

#include <string_view>

#include "daemon/world/io/text_number.hpp"
#include "hal/base/geometry.hpp"

namespace thimble::world {

// Beyond this a mesh is of nothing that can be touched.
inline constexpr double kFurthestCorner = 1e9;

[[nodiscard]] inline bool is_corner(Position3 at) noexcept {
  const auto is_near = [](double v) { return v >= -kFurthestCorner && v <= kFurthestCorner; };
  return is_near(at.x) && is_near(at.y) && is_near(at.z);
}

// False: one of the three words is no number, or beyond what a corner may be.
[[nodiscard]] inline bool parse_corner(std::string_view x, std::string_view y, std::string_view z,
                                       Position3& out) noexcept {
  return parse_number(x, out.x) && parse_number(y, out.y) && parse_number(z, out.z) &&
         is_corner(out);
}

}  // namespace thimble::world
