#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "daemon/world/cam/automaton.hpp"
#include "hal/base/result.hpp"

namespace thimble::world::cam {

// Ours: 2^18 cells of two bytes, the most a live world has, and their header.
inline constexpr std::size_t kMaxStateBytes = (std::size_t{1} << 19) + 4096;

// A state as an NRRD file, which other programs read as the volume of 16-bit cells that it is
// (decision 0343); two keys of ours in the header say the rule and the steps taken.
[[nodiscard]] std::string to_nrrd(const AutomatonState& state);

// Pure and total: any bytes give a state with as many sites as its axes say, or an error.
// Malformed: not the format, or sizes that are no powers of two; Unsupported: an NRRD file that
// to_nrrd() did not write; TooLarge: beyond kMaxStateBytes.
[[nodiscard]] Result<AutomatonState> parse_state(std::string_view bytes);

}  // namespace thimble::world::cam
