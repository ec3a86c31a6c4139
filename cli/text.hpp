#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace thimble::cli {

// Which characters a terminal shows; all take one column.
enum class Glyphs { Ascii, Unicode };

// Columns that `text` takes: UTF-8 of our own making, one column for each character.
[[nodiscard]] std::size_t columns_of(std::string_view text);
// `text` in exactly `width` columns: cut or filled with spaces.
[[nodiscard]] std::string fit(std::string_view text, std::size_t width);
// Text from outside, made harmless: whatever is not printable ASCII becomes '?'.
[[nodiscard]] std::string plain(std::string_view text);
// `text` cut at spaces into lines of at most `width` columns, each behind `indent` spaces.
[[nodiscard]] std::string wrap(std::string_view text, std::size_t width, std::size_t indent);

// "+12.3"; "-" for what is not finite; never longer than 12 characters.
[[nodiscard]] std::string signed_fixed(double value, int decimals);
[[nodiscard]] std::string fixed(double value, int decimals);
// A time with a fitting unit: "12.3 us", "1.00 ms", "2.50 s"; "-" for what is not finite.
[[nodiscard]] std::string time_text(double time_s, Glyphs glyphs);
// "01:02:03"
[[nodiscard]] std::string uptime_text(double time_s);

// `fraction` of `width` columns filled; everything beyond 0..1 and NaN is clamped.
[[nodiscard]] std::string bar(double fraction, std::size_t width, Glyphs glyphs);

}  // namespace thimble::cli
