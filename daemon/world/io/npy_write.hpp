#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace thimble::world {

// The header of a NumPy file, format 1.0, of an array [x, y, z] whose numbers follow it, x fastest.
// `descr` as NumPy calls their type: "<u2". Pure.
[[nodiscard]] std::string npy_head(std::string_view descr,
                                   const std::array<std::uint32_t, 3>& sizes);

}  // namespace thimble::world
