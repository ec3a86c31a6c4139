#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/spacemouse/spacemouse_wire.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::spacemouse {

// What one report says; what it does not speak of is nothing.
struct PuckReport {
  std::optional<std::array<std::int16_t, 3>> translation;  // counts, axes of the puck
  std::optional<std::array<std::int16_t, 3>> rotation;     // counts
  std::optional<std::uint32_t> buttons;                    // the first 32 of them
  bool operator==(const PuckReport&) const = default;
};

// Pure and total: any bytes give a report or nothing. A report of another number (a battery's, a
// maker's own) is one that says nothing. Nothing for no bytes, and for axes or buttons that lack.
// Thread: any. RT: THIMBLE_RT.
THIMBLE_RT [[nodiscard]] std::optional<PuckReport> parse_report(
    std::span<const std::uint8_t> bytes) noexcept;

}  // namespace thimble::spacemouse
