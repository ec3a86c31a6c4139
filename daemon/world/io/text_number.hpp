#pragma once

#include <charconv>
#include <string_view>
#include <system_error>
#include <type_traits>

namespace thimble::world {

// The number that `text` is from its first to its last character; a + in front is allowed.
template <class Number>
[[nodiscard]] bool parse_number(std::string_view text, Number& out) noexcept {
  if (text.starts_with('+')) text.remove_prefix(1);
  if (text.empty() || text.front() == '+') return false;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, out);
  return error == std::errc{} && rest == end;
}

}  // namespace thimble::world
