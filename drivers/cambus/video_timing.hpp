#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "drivers/cambus/cambus_page_wire.hpp"

namespace thimble::cambus {

// The lines and frames of a monitor, by a board's clock: 525 lines, about 60 times a second (59.97
// at 25 MHz, 59.90 at 20, 59.17 at 21).
//
// Source: docs/cambus.md, section 4 (MIT's step/step-xlat.fth has those of 20, 21 and 25 MHz).
struct VideoTiming {
  std::uint32_t scan_clocks{0}, blank_clocks{0};  // of a line
  std::uint32_t scan_lines{0}, blank_lines{0};    // of a frame
  bool operator==(const VideoTiming&) const = default;

  [[nodiscard]] std::uint32_t line_clocks() const noexcept { return scan_clocks + blank_clocks; }
  [[nodiscard]] std::uint32_t frame_clocks() const noexcept {
    return line_clocks() * (scan_lines + blank_lines);
  }
  // Of the host registers 2 and 3.
  [[nodiscard]] std::uint32_t scan_length() const noexcept {
    return scan_lines << page::kLinesShift | scan_clocks;
  }
  [[nodiscard]] std::uint32_t blank_length() const noexcept {
    return blank_lines << page::kLinesShift | blank_clocks;
  }
};

// Log2 of the sites of the longest line, and of the most lines.
inline constexpr int kLog2LineSites = 9;
inline constexpr int kLog2Lines = 9;

// Nothing: too slow for a line of 512 sites, or so fast that a line has more clocks than 16 bits
// say. Pure.
[[nodiscard]] std::optional<VideoTiming> video_timing(std::uint32_t clock_hz) noexcept;

}  // namespace thimble::cambus
