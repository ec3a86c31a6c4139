#pragma once

#include <cstddef>
#include <string>

#include "cli/text.hpp"
#include "daemon/api/status.hpp"

namespace thimble::cli {

// All pictures but render_line() fit this width; control characters of the document never get
// through.
inline constexpr std::size_t kColumns = 80;

// Pure functions of a status document: lines that end in a line break.

// `thimble status`: everything, once.
[[nodiscard]] std::string render_status(const api::Status& status, Glyphs glyphs);
// `thimble watch` on a terminal of `rows` lines: with the finger in its world where there is
// room for it, never more than `rows` - 1 lines.
[[nodiscard]] std::string render_watch(const api::Status& status, Glyphs glyphs, std::size_t rows);
// `thimble watch` elsewhere: one line for each arm, whole, for programs to read.
[[nodiscard]] std::string render_line(const api::Status& status);
// `thimble report`: what a finished session was like.
[[nodiscard]] std::string render_report(const api::Status& status, Glyphs glyphs);

}  // namespace thimble::cli
