#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "cli/flight/recording.hpp"
#include "cli/flight/report.hpp"
#include "hal/base/check.hpp"

// Any bytes of a file give a refusal in one line, or a report that fits a terminal.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thimble;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto recording = flight::parse_recording(text);
  if (!recording) {
    THIMBLE_CHECK(recording.error().message.find('\n') == std::string::npos);
    return 0;
  }
  std::size_t columns = 0;
  for (const char c : flight::render(*recording, 0.05, cli::Glyphs::Ascii)) {
    columns = c == '\n' ? 0 : columns + 1;
    THIMBLE_CHECK(columns <= 80);
    THIMBLE_CHECK(c == '\n' || (c >= 0x20 && c < 0x7F));
  }
  return 0;
}
