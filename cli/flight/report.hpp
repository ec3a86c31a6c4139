#pragma once

#include <cstddef>
#include <string>

#include "cli/flight/recording.hpp"
#include "cli/text.hpp"

namespace thimble::flight {

// What the 50 ms before a stop were like is what a person asks first.
inline constexpr double kDefaultBefore_s = 0.05;
// Of the table: more rows than this stand for several ticks each, by their worst.
inline constexpr std::size_t kMaxRows = 50;

// The cause in words, what force, speed and offset were over the whole recording, and a table of
// the `before_s` before the fault was latched (or before the end, when no tick has one). Pure;
// every line fits 80 columns; control characters of the file never get through.
[[nodiscard]] std::string render(const Recording& recording, double before_s, cli::Glyphs glyphs);

}  // namespace thimble::flight
