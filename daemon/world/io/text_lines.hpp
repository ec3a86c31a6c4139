#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/world/io/buffered_source.hpp"
#include "hal/base/result.hpp"

namespace thimble::world {

// The lines of a text and the words of each, between blanks.
//
// Thread: one. Not RT. Ownership: `text` must outlive it. Holds a line. Errors: Malformed for a
// line beyond kMaxLineBytes; what text says.
class TextLines {
 public:
  static constexpr std::size_t kMaxLineBytes = 8192;

  explicit TextLines(BufferedSource& text) : text_(text) {}

  // False at the end of the text.
  [[nodiscard]] Result<bool> next();
  // Of the line that next() found; good until it is called again. May be none.
  [[nodiscard]] const std::vector<std::string_view>& words() const noexcept { return words_; }
  // "line 12", for messages.
  [[nodiscard]] std::string place() const { return "line " + std::to_string(number_); }

 private:
  [[nodiscard]] Result<bool> take_line();

  BufferedSource& text_;
  std::string line_{};
  std::vector<std::string_view> words_{};
  std::size_t number_{0};
};

}  // namespace thimble::world
