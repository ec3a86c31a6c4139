#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "cli/cam/pattern.hpp"

// Any bytes give a pattern of the size that it says, or a reason; and what is written of it is the
// same pattern again.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace cam = thimble::cam;
  const auto pattern = cam::parse_rle({reinterpret_cast<const char*>(data), size});
  if (!pattern) return 0;
  if (pattern->cells.size() != pattern->size[0] * pattern->size[1]) std::abort();
  if (pattern->cells.size() > 1U << 20) return 0;
  const auto again = cam::parse_rle(cam::to_rle(*pattern, "any"));
  if (!again || again->cells != pattern->cells) std::abort();
  return 0;
}
