#include <algorithm>
#include <charconv>

#include "cli/cam/pattern.hpp"

namespace thimble::cam {
namespace {

constexpr std::size_t kMaxLine = 70;  // of what is written; the formats' own

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::string_view take_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

void skip_blanks(std::string_view& text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
}

// A number from the front; none where there is none or it is too large for any pattern.
bool take_number(std::string_view& text, std::size_t& out) {
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), out);
  if (error != std::errc{} || out > kMaxPatternCells) return false;
  text.remove_prefix(static_cast<std::size_t>(rest - text.data()));
  return true;
}

// "x = 3": the name, and what follows its equals sign.
bool take_size(std::string_view& text, char name, std::size_t& out) {
  skip_blanks(text);
  if (text.empty() || text.front() != name) return false;
  text.remove_prefix(1);
  skip_blanks(text);
  if (text.empty() || text.front() != '=') return false;
  text.remove_prefix(1);
  skip_blanks(text);
  return take_number(text, out);
}

Result<void> parse_head(std::string_view line, Pattern& pattern) {
  const bool has_x = take_size(line, 'x', pattern.size[0]);
  skip_blanks(line);
  const bool has_comma = has_x && !line.empty() && line.front() == ',';
  if (has_comma) line.remove_prefix(1);
  if (!has_comma || !take_size(line, 'y', pattern.size[1])) {
    return fail(Errc::Malformed, "this is no RLE pattern: it has no line \"x = …, y = …\"");
  }
  // Neither is above the limit, so the product cannot overflow.
  if (pattern.size[0] * pattern.size[1] > kMaxPatternCells) {
    return fail(Errc::TooLarge, "the RLE pattern has more than 2^28 cells");
  }
  return {};
}

// The state behind a count: of more than one letter from the 25th on.
char take_state(std::string_view& text) {
  const char state = text.front();
  text.remove_prefix(1);
  if (state >= 'p' && state <= 'y' && !text.empty() && text.front() >= 'A' && text.front() <= 'X') {
    text.remove_prefix(1);
  }
  return state;
}

Result<void> put_run(Pattern& pattern, std::size_t& x, std::size_t y, std::size_t run, char state) {
  const bool is_letter = (state >= 'a' && state <= 'z') || (state >= 'A' && state <= 'Z');
  if (!is_letter && state != '.') {
    return fail(Errc::Malformed, "the RLE pattern has a character that means nothing");
  }
  if (y >= pattern.size[1] || run > pattern.size[0] - x) {
    return fail(Errc::Malformed, "the RLE pattern goes beyond its own size");
  }
  if (state != 'b' && state != '.') {
    const auto first =
        pattern.cells.begin() + static_cast<std::ptrdiff_t>(pattern.index_of(x, y, 0));
    std::fill_n(first, run, true);
  }
  x += run;
  return {};
}

}  // namespace

Result<Pattern> parse_rle(std::string_view text) {
  Pattern pattern;
  std::string_view line = take_line(text);
  while (line.starts_with('#')) line = take_line(text);
  if (const auto head = parse_head(line, pattern); !head) return tl::unexpected(head.error());
  pattern.cells.resize(pattern.size[0] * pattern.size[1]);
  std::size_t x = 0;
  std::size_t y = 0;
  for (skip_blanks(text); !text.empty() && text.front() != '!'; skip_blanks(text)) {
    std::size_t run = 1;
    if (is_digit(text.front()) && (!take_number(text, run) || run == 0)) {
      return fail(Errc::Malformed, "the RLE pattern has a count that cannot be");
    }
    if (text.empty()) break;
    if (text.front() == '$') {
      text.remove_prefix(1);
      x = 0;
      y = std::min(y + run, pattern.size[1]);
      continue;
    }
    const char state = take_state(text);
    if (const auto put = put_run(pattern, x, y, run, state); !put) {
      return tl::unexpected(put.error());
    }
  }
  return pattern;
}

std::string to_rle(const Pattern& pattern, std::string_view rule) {
  std::string text = "x = " + std::to_string(pattern.size[0]) +
                     ", y = " + std::to_string(pattern.size[1]) + ", rule = " + std::string(rule) +
                     "\n";
  std::size_t line = 0;
  const auto put = [&](std::size_t run, char what) {
    const std::string item = (run > 1 ? std::to_string(run) : "") + what;
    if (line + item.size() > kMaxLine) {
      text += '\n';
      line = 0;
    }
    text += item;
    line += item.size();
  };
  std::size_t rows = 0;
  for (std::size_t y = 0; y < pattern.size[1]; ++y, ++rows) {
    for (std::size_t x = 0; x < pattern.size[0];) {
      const bool is_set = pattern.cells[pattern.index_of(x, y, 0)];
      std::size_t end = x;
      while (end < pattern.size[0] && pattern.cells[pattern.index_of(end, y, 0)] == is_set) ++end;
      if (is_set || end < pattern.size[0]) {
        if (rows > 0) put(rows, '$');
        rows = 0;
        put(end - x, is_set ? 'o' : 'b');
      }
      x = end;
    }
  }
  put(1, '!');
  return text + "\n";
}

}  // namespace thimble::cam
