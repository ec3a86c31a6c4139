#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

namespace thimble::plugin {

// Text of the plugin ABI: an array that a zero byte ends.

// What a plugin wrote, whether it ended it or not; control characters as '?', so that it fits on
// a terminal and one line.
template <std::size_t Bytes>
[[nodiscard]] std::string text_of(const char (&array)[Bytes]) {
  std::string text(array, std::find(array, array + Bytes, '\0'));
  std::replace_if(
      text.begin(), text.end(),
      [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }, '?');
  return text;
}

// For a plugin to read; what does not fit is cut.
template <std::size_t Bytes>
void put_text(std::string_view text, char (&array)[Bytes]) {
  const std::size_t size = std::min(text.size(), Bytes - 1);
  std::copy_n(text.begin(), size, array);
  std::fill(array + size, array + Bytes, '\0');
}

// What the ABI calls a name: 1 to 31 of a-z, 0-9 and -, ended by a zero byte.
template <std::size_t Bytes>
[[nodiscard]] bool is_name(const char (&array)[Bytes]) {
  const char* end = std::find(array, array + Bytes, '\0');
  return end != array && end != array + Bytes && std::all_of(array, end, [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
         });
}

}  // namespace thimble::plugin
