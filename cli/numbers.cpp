#include "cli/numbers.hpp"

#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>

#include "cli/text.hpp"

namespace thimble::cli {
namespace {

template <class Number>
bool read_all(std::string_view text, Number& out) {
  const char* end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, out);
  return error == std::errc() && stopped == end;
}

std::string found(std::string_view text) { return ", found \"" + plain(text) + "\""; }

}  // namespace

std::string refuse_whole_number(std::string_view text, std::uint64_t least, std::uint64_t most) {
  std::uint64_t number = 0;
  const bool is_padded = text.size() > 1 && text.front() == '0';
  if (!is_padded && read_all(text, number) && number >= least && number <= most) return "";
  return "expected a whole number from " + std::to_string(least) + " to " + std::to_string(most) +
         found(text);
}

std::string refuse_other_than_whole(const std::string& text) {
  return refuse_whole_number(text, 0, std::numeric_limits<std::uint64_t>::max());
}

std::string refuse_other_than_seed(const std::string& text) {
  return refuse_whole_number(text, 0, std::uint64_t{1} << std::numeric_limits<double>::digits);
}

std::string refuse_finite_number(std::string_view text) {
  std::string_view digits = text;
  if (digits.starts_with('+') && !digits.starts_with("+-")) digits.remove_prefix(1);
  double number = 0;
  if (read_all(digits, number) && std::isfinite(number)) return "";
  return "expected a finite number" + found(text);
}

}  // namespace thimble::cli
