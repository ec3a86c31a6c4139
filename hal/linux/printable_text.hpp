#pragma once

#include <string>
#include <string_view>

namespace thimble::linux {

// Words of a device, fit for a log, a document and a terminal: whatever is not printable ASCII
// becomes '?', so that a device can neither break a line nor steer a terminal.
// Thread: any. Pure. Total.
[[nodiscard]] inline std::string printable_text(std::string_view text) {
  std::string out(text);
  for (char& letter : out) {
    if (letter < ' ' || letter > '~') letter = '?';
  }
  return out;
}

// The same of several lines, whose breaks stay.
[[nodiscard]] inline std::string printable_lines(std::string_view text) {
  std::string out = printable_text(text);
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\n') out[i] = '\n';
  }
  return out;
}

}  // namespace thimble::linux
