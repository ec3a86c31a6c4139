#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/phantom/text_codec.hpp"
#include "drivers/phantom/zero_jump.hpp"
#include "hal/base/check.hpp"

// Any stream gives lines of bounded length, and of each a report or nothing; what is left over is
// counted.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace phantom = thimble::phantom;
  phantom::TextLines lines;
  phantom::ZeroJump jump;
  std::size_t in_lines = 0;
  for (const std::uint8_t byte : std::span(data, size)) {
    const std::span<const std::uint8_t> line = lines.take(byte);
    in_lines += line.size();
    if (line.empty()) continue;
    THIMBLE_CHECK(line.front() == '[' && line.back() == ']');
    THIMBLE_CHECK(line.size() <= phantom::TextLines::kMostBytes);
    const auto report = phantom::parse_text_report(line);
    if (!report) continue;
    jump.on_counts({report->counts[0], report->counts[1], report->counts[2]},
                   std::chrono::milliseconds(1));
  }
  THIMBLE_CHECK(in_lines + lines.lost_bytes() <= size);
  static_cast<void>(phantom::parse_text_report({data, size}));
  return 0;
}
