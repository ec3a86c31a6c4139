#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "cli/text.hpp"

namespace thimble::cli {

// What the locale of this process can show.
[[nodiscard]] Glyphs glyphs_of_environment();

// What a terminal is sent to show `picture` in place of the one before, without a flicker: each
// line is overwritten and its rest erased, never the whole screen first.
[[nodiscard]] std::string redraw(std::string_view picture);

// Standard output as a screen: hides the cursor on a screen of its own while it lives, and
// leaves the terminal as it was.
// Thread: one.
class Screen {
 public:
  Screen();
  ~Screen();
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  [[nodiscard]] bool is_terminal() const noexcept { return is_terminal_; }
  [[nodiscard]] Glyphs glyphs() const noexcept { return glyphs_; }
  [[nodiscard]] std::size_t rows() const;  // now; a window may be resized
  void draw(std::string_view picture) const;

 private:
  bool is_terminal_;
  Glyphs glyphs_;
};

}  // namespace thimble::cli
