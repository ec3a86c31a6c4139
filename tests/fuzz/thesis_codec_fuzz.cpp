#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "daemon/link/thesis_codec.hpp"

// Whatever is taken is finite and within the arm's reach, and says the same when sent again.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thimble::link;
  const auto bytes = std::as_bytes(std::span(data, size));
  if (const auto hand = decode_thesis_request(bytes)) {
    const auto again = encode_thesis_request(*hand);
    if (!again || !decode_thesis_request(*again)) std::abort();
  }
  const auto planes = decode_thesis_reply(bytes);
  if (!planes) return 0;
  if (planes->size() > 3) std::abort();
  thimble::Position3 hand{};  // a hand that has passed every plane, so that all are sent
  for (const auto& plane : *planes) {
    if (!(std::abs(plane.offset_m) <= kMaxThesisCoordinate_m)) std::abort();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (plane.normal[axis] != 0) hand[axis] = plane.normal[axis] * (plane.offset_m + 0.001);
    }
  }
  const EncodedReply again = encode_thesis_reply(hand, *planes);
  if (again.unencodable != 0) std::abort();
  if (!decode_thesis_reply(again.bytes)) std::abort();
  return 0;
}
