#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "hal/rt/annotations.hpp"

namespace thimble::sim {

// What the board of the text protocol reads of a message, from its '[' on: its source asks the C
// library's scanf for "[%d,%d,%d]" and wants three numbers. So blanks may stand before a number, a
// sign too, and what stands behind the third is not looked at. Total: a number beyond 32 bits is
// the largest or the smallest, as the board's C library has it. Nothing: there are no three. mA.
// Thread: any. Pure.
THIMBLE_RT [[nodiscard]] std::optional<std::array<std::int32_t, 3>> scan_currents(
    std::string_view message) noexcept;

}  // namespace thimble::sim
