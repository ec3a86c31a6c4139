#include "sim/model/arm/text_message.hpp"

#include <algorithm>
#include <limits>

namespace thimble::sim {
namespace {

constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
constexpr std::int64_t kLeast = std::numeric_limits<std::int32_t>::min();

bool take_letter(std::string_view& rest, char letter) noexcept {
  if (!rest.starts_with(letter)) return false;
  rest.remove_prefix(1);
  return true;
}

std::optional<std::int32_t> take_number(std::string_view& rest) noexcept {
  constexpr std::string_view kBlanks = " \t\n\v\f\r";
  rest.remove_prefix(std::min(rest.find_first_not_of(kBlanks), rest.size()));
  const bool is_negative = rest.starts_with('-');
  if (is_negative || rest.starts_with('+')) rest.remove_prefix(1);
  std::int64_t number = 0;
  std::size_t digits = 0;
  for (; digits < rest.size() && rest[digits] >= '0' && rest[digits] <= '9'; ++digits) {
    number = std::min(10 * number + (rest[digits] - '0'), kMost + 1);
  }
  if (digits == 0) return std::nullopt;
  rest.remove_prefix(digits);
  return static_cast<std::int32_t>(std::clamp(is_negative ? -number : number, kLeast, kMost));
}

}  // namespace

std::optional<std::array<std::int32_t, 3>> scan_currents(std::string_view message) noexcept {
  std::array<std::int32_t, 3> all{};
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!take_letter(message, i == 0 ? '[' : ',')) return std::nullopt;
    const std::optional<std::int32_t> number = take_number(message);
    if (!number) return std::nullopt;
    all[i] = *number;
  }
  return all;
}

}  // namespace thimble::sim
