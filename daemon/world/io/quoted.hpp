#pragma once

#include <string>
#include <string_view>

namespace thimble::world {

// A few characters from outside in quotes, fit for a message.
[[nodiscard]] inline std::string quoted(std::string_view text) {
  std::string out = "'";
  for (const char c : text.substr(0, 24)) out += c >= ' ' && c <= '~' ? c : '?';
  return out + (text.size() > 24 ? "...'" : "'");
}

}  // namespace thimble::world
