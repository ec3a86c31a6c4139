#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "guard/handover.hpp"

// Whatever is taken fits, and says the same when sent again.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thimble::guard;
  const std::span<const std::uint8_t> packet(data, size);
  const auto handover = parse_handover(packet);
  if (!handover) return 0;
  if (handover->size == 0 || handover->size > kMaxZeroBytes) std::abort();
  if (!std::ranges::equal(encode(*handover), packet)) std::abort();
  return 0;
}
