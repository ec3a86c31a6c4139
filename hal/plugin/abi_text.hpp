#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

namespace thimble::plugin {

// Text of the plugin ABI: an array that a zero byte ends.
//
// Thread: any. Not RT: strings are made. Ownership: what is returned is the caller's. Errors: none;
// what cannot be shown or does not fit is replaced or cut, as each says.

// `text` with a '?' for each byte that is no UTF-8 (RFC 3629) and for each control character, C1
// among them: it fits on a terminal, one line, and into JSON.
[[nodiscard]] std::string plain_utf8(std::string_view text);

// What a plugin wrote, whether it ended it or not, plain.
template <std::size_t Bytes>
[[nodiscard]] std::string text_of(const char (&array)[Bytes]) {
  const char* end = std::find(array, array + Bytes, '\0');
  return plain_utf8({array, static_cast<std::size_t>(end - array)});
}

// For a plugin to read; what does not fit is cut, between characters.
template <std::size_t Bytes>
void put_text(std::string_view text, char (&array)[Bytes]) {
  std::size_t size = std::min(text.size(), Bytes - 1);
  const auto is_inside = [text](std::size_t at) {
    return at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0U) == 0x80;
  };
  while (size > 0 && is_inside(size)) --size;
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
