#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "drivers/falcon/falcon_codec.hpp"

// Any bytes, cut into packets of the bridge: what is not lost is a report or the beginning of one,
// and whatever came before, a report after a pause in which nothing was held is found.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace falcon = thimble::falcon;
  falcon::RunParser parser;
  std::span<const std::uint8_t> rest(data, size);
  std::uint64_t fed = 0;
  std::uint64_t reported = 0;
  while (!rest.empty()) {
    const std::size_t packet_bytes = std::min<std::size_t>(rest.size(), 1 + rest.front() % 64);
    for (const std::uint8_t byte : falcon::serial_bytes(rest.first(packet_bytes))) {
      ++fed;
      const auto report = parser.take(byte);
      if (!report) continue;
      ++reported;
      if ((report->buttons | report->homed) > 0x7f) std::abort();
    }
    rest = rest.subspan(packet_bytes);
  }
  const std::uint64_t used = parser.lost_bytes() + reported * falcon::wire::kRunBytes;
  if (used > fed || fed - used >= falcon::wire::kRunBytes) std::abort();
  parser.forget();
  bool is_found = false;
  for (const std::uint8_t byte : falcon::encode_run_command({})) {
    is_found = parser.take(byte).has_value();
  }
  if (!is_found) std::abort();
  return 0;
}
