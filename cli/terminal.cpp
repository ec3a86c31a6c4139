#include "cli/terminal.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>
#include <iostream>

namespace thimble::cli {
namespace {

// ECMA-48 and xterm: alternate screen, cursor, home, erase to the end of line and of screen.
constexpr std::string_view kEnter = "\x1b[?1049h\x1b[?25l";
constexpr std::string_view kLeave = "\x1b[?25h\x1b[?1049l";
constexpr std::string_view kHome = "\x1b[H";
constexpr std::string_view kEraseLine = "\x1b[K";
constexpr std::string_view kEraseBelow = "\x1b[J";

constexpr std::size_t kDefaultRows = 24;

}  // namespace

Glyphs glyphs_of_environment() {
  // The order of POSIX: the first that is set decides.
  for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    const char* value = std::getenv(name);
    if (value == nullptr || *value == '\0') continue;
    const std::string_view locale = value;
    for (const char* word : {"UTF-8", "utf-8", "UTF8", "utf8"}) {
      if (locale.find(word) != std::string_view::npos) return Glyphs::Unicode;
    }
    return Glyphs::Ascii;
  }
  return Glyphs::Ascii;
}

std::string redraw(std::string_view picture) {
  std::string out(kHome);
  for (const char c : picture) {
    if (c == '\n') {
      out.append(kEraseLine).append("\r\n");
    } else {
      out += c;
    }
  }
  return out.append(kEraseBelow);
}

Screen::Screen() : is_terminal_(::isatty(STDOUT_FILENO) == 1), glyphs_(glyphs_of_environment()) {
  if (is_terminal_) std::cout << kEnter << std::flush;
}

Screen::~Screen() {
  if (is_terminal_) std::cout << kLeave << std::flush;
}

std::size_t Screen::rows() const {
  winsize size{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_row == 0) return kDefaultRows;
  return size.ws_row;
}

void Screen::draw(std::string_view picture) const { std::cout << redraw(picture) << std::flush; }

}  // namespace thimble::cli
