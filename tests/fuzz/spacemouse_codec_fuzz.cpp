#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "drivers/spacemouse/spacemouse_codec.hpp"

// Any bytes give a report of what its number says, or nothing.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace spacemouse = thimble::spacemouse;
  const auto report = spacemouse::parse_report({data, size});
  if (!report) return 0;
  if (size == 0) std::abort();
  if (report->translation && data[0] != spacemouse::wire::kTranslationReport) std::abort();
  if (report->rotation && size == spacemouse::wire::kSeparateBytes &&
      data[0] != spacemouse::wire::kRotationReport) {
    std::abort();
  }
  if (report->buttons && data[0] != spacemouse::wire::kButtonReport) std::abort();
  return 0;
}
