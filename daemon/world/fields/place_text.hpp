#pragma once

#include <array>
#include <cstdio>
#include <string>

#include "hal/base/geometry.hpp"

namespace thimble::world {

// A place for a message, in the unit that its numbers have.
[[nodiscard]] inline std::string text_of(Position3 at) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "(%.6g, %.6g, %.6g)", at.x, at.y, at.z);
  return text.data();
}

}  // namespace thimble::world
