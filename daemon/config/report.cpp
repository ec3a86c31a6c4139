#include "daemon/config/report.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <numeric>
#include <utility>

namespace thimble::config {
namespace {

constexpr std::size_t kMaxShownBytes = 60;
constexpr std::size_t kMaxComparedBytes = 40;  // longer words are no slip of the finger

// Insertions, deletions and replacements that turn one word into the other (Levenshtein).
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
    }
  }
  return row.back();
}

// Of a letter that begins there and ends a line, steers a terminal or turns what follows round:
// the control characters C0 and C1, and Unicode's marks of lines and of direction. 0: it is none.
std::size_t steering_bytes(std::string_view text) {
  const auto at = [&](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U;
  };
  if (at(0) < 0x20 || at(0) == 0x7F) return 1;
  if (at(0) == 0xC2 && at(1) >= 0x80 && at(1) <= 0x9F) return 2;  // U+0080 to U+009F
  if (at(0) != 0xE2) return 0;
  const unsigned last = at(2);
  // U+200E, U+200F, U+2028 to U+202E; U+2066 to U+2069.
  const bool is_mark = last == 0x8E || last == 0x8F || (last >= 0xA8 && last <= 0xAE);
  if (at(1) == 0x80) return is_mark ? 3 : 0;
  return at(1) == 0x81 && last >= 0xA6 && last <= 0xA9 ? 3 : 0;
}

bool is_continuation(char byte) { return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U; }

}  // namespace

void Report::add(const Place& place, std::string_view key, std::string_view message) {
  if (errors_.size() >= kMaxErrors) {
    ++left_out_;
    return;
  }
  errors_.push_back(
      {escaped(place.file), place.line, place.column, escaped(key), escaped(message)});
}

bool Report::has_mistake(std::string_view key) const {
  return std::any_of(errors_.begin(), errors_.end(),
                     [word = escaped(key)](const auto& error) { return error.key == word; });
}

std::vector<ConfigError> Report::take() {
  std::stable_sort(errors_.begin(), errors_.end(), [](const auto& a, const auto& b) {
    const bool is_a_override = a.file.starts_with("--set ");
    const bool is_b_override = b.file.starts_with("--set ");
    if (is_a_override != is_b_override) return is_b_override;
    return std::pair(a.line, a.column) < std::pair(b.line, b.column);
  });
  if (left_out_ > 0) {
    errors_.push_back(
        {errors_.front().file, 0, 0, "", "and " + std::to_string(left_out_) + " more mistakes"});
  }
  return std::exchange(errors_, {});
}

std::string escaped(std::string_view text) {
  std::string out;
  std::size_t steering = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (steering == 0) steering = steering_bytes(text.substr(i));
    if (steering == 0) {
      out += text[i];
      continue;
    }
    --steering;
    constexpr std::string_view kDigits = "0123456789abcdef";
    const auto byte = static_cast<unsigned char>(text[i]);
    out += "\\x";
    out += kDigits[byte >> 4U];
    out += kDigits[byte & 0xFU];
  }
  return out;
}

std::string in_quotes(std::string_view text) {
  std::string out = "\"";
  std::size_t size = std::min(text.size(), kMaxShownBytes);
  while (size < text.size() && size > 0 && is_continuation(text[size])) --size;
  out += escaped(text.substr(0, size));
  return out += size < text.size() ? "…\"" : "\"";
}

std::string shown(double value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), end.ptr};
}

std::string_view nearest(std::string_view word, const std::vector<std::string>& words) {
  if (word.size() > kMaxComparedBytes) return {};
  std::string_view best;
  // A third of the letters may be wrong, as long as something is left to recognise.
  std::size_t best_distance = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const std::string& candidate : words) {
    if (candidate.starts_with(std::string(word) + "_")) return candidate;  // the unit forgotten
    const std::size_t distance = edit_distance(word, candidate);
    if (distance >= best_distance) continue;
    best = candidate;
    best_distance = distance;
  }
  return best;
}

std::string to_string(const ConfigError& error) {
  std::string out = error.file;
  if (error.line > 0) out += ":" + std::to_string(error.line);
  if (error.line > 0 && error.column > 0) out += ":" + std::to_string(error.column);
  if (!out.empty()) out += ": ";
  if (!error.key.empty()) out += error.key + ": ";
  return out + error.message;
}

}  // namespace thimble::config
