#include "cli/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace thimble::cli {
namespace {

bool is_continuation(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }

// Of the characters that take up to so many columns; never half of one.
std::size_t bytes_within(std::string_view text, std::size_t columns) {
  std::size_t seen = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (!is_continuation(text[i]) && ++seen > columns) return i;
  }
  return text.size();
}

std::string print(const char* format, int decimals, double value) {
  if (!std::isfinite(value)) return "-";
  std::array<char, 32> buffer{};
  // Beyond that no column holds it, and nobody reads the decimals.
  if (std::abs(value) >= 1e6) {
    std::snprintf(buffer.data(), buffer.size(), "%.3g", value);
  } else {
    std::snprintf(buffer.data(), buffer.size(), format, decimals, value);
  }
  return buffer.data();
}

}  // namespace

std::size_t columns_of(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return !is_continuation(c); }));
}

std::string fit(std::string_view text, std::size_t width) {
  std::string out;
  std::size_t columns = 0;
  for (const char c : text) {
    if (!is_continuation(c) && ++columns > width) break;
    out += c;
  }
  return out.append(width - std::min(columns, width), ' ');
}

std::string plain(std::string_view text) {
  std::string out(text);
  std::replace_if(
      out.begin(), out.end(), [](char c) { return c < 0x20 || c > 0x7E; }, '?');
  return out;
}

std::string wrap(std::string_view text, std::size_t width, std::size_t indent) {
  std::string out;
  const std::size_t room = width > indent ? width - indent : 1;
  while (!text.empty()) {
    std::size_t size = bytes_within(text, room);
    if (size < text.size()) {
      const std::size_t space = text.substr(0, size + 1).rfind(' ');
      if (space != std::string_view::npos && space > 0) size = space;
    }
    out.append(indent, ' ').append(text.substr(0, size)) += '\n';
    text.remove_prefix(size);
    text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  }
  return out;
}

std::string signed_fixed(double value, int decimals) { return print("%+.*f", decimals, value); }
std::string fixed(double value, int decimals) { return print("%.*f", decimals, value); }

std::string time_text(double time_s, Glyphs glyphs) {
  const double size = std::abs(time_s);
  if (!std::isfinite(time_s)) return "-";
  if (size < 1e-3) return fixed(time_s * 1e6, 1) + (glyphs == Glyphs::Unicode ? " µs" : " us");
  if (size < 1) return fixed(time_s * 1e3, 2) + " ms";
  return fixed(time_s, 2) + " s";
}

std::string uptime_text(double time_s) {
  if (!(time_s >= 0 && time_s < 1e9)) return "-";
  const auto whole = static_cast<long>(time_s);
  std::array<char, 40> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%02ld:%02ld:%02ld", whole / 3600, whole / 60 % 60,
                whole % 60);
  return buffer.data();
}

std::string bar(double fraction, std::size_t width, Glyphs glyphs) {
  const double clamped = fraction > 0 ? std::min(fraction, 1.0) : 0;
  const auto full = static_cast<std::size_t>(std::lround(clamped * static_cast<double>(width)));
  std::string out;
  for (std::size_t i = 0; i < width; ++i) {
    const bool is_full = i < full;
    if (glyphs == Glyphs::Unicode) {
      out += is_full ? "█" : "·";
    } else {
      out += is_full ? '#' : '.';
    }
  }
  return out;
}

}  // namespace thimble::cli
