#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>

#include "cli/render.hpp"
#include "cli/status_document.hpp"
#include "hal/base/check.hpp"

namespace {

void check_picture(std::string_view picture, std::size_t width) {
  std::size_t columns = 0;
  for (const char c : picture) {
    columns = c == '\n' ? 0 : columns + 1;
    THIMBLE_CHECK(columns <= width);
    THIMBLE_CHECK(c == '\n' || (c >= 0x20 && c < 0x7F));
  }
}

}  // namespace

// Any bytes that a socket may answer give a refusal, or pictures that fit a terminal.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thimble::cli;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  static_cast<void>(parse_error_message(bytes, "?"));
  const auto status = parse_status(bytes);
  if (!status) return 0;
  check_picture(render_status(*status, Glyphs::Ascii), kColumns);
  check_picture(render_watch(*status, Glyphs::Ascii, 40), kColumns);
  check_picture(render_report(*status, Glyphs::Ascii), kColumns);
  // For programs, which have no width.
  check_picture(render_line(*status), std::numeric_limits<std::size_t>::max());
  return 0;
}
