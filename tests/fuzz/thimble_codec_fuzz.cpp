#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "daemon/link/thimble_codec.hpp"

namespace {

using namespace thimble::link;
using Content = std::array<std::byte, kMaxThimbleContent>;

// Whatever is taken can be sent, and means the same when it arrives.
template <class Message>
void take(std::span<const std::byte> content) {
  Message message;
  if (!decode(content, message)) return;
  Content first{};
  const auto size = encode(message, first);
  if (!size) std::abort();
  Message again;
  if (!decode(std::span(first).first(*size), again)) std::abort();
  Content second{};
  const auto same_size = encode(again, second);
  if (!same_size || *same_size != *size || first != second) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = std::as_bytes(std::span(data, size));
  const auto header = decode_header(bytes);
  if (!header) return 0;
  if (!is_thimble_datagram(bytes)) std::abort();
  std::array<std::byte, kThimbleHeaderSize> again{};
  encode_header(*header, again);
  if (!std::equal(again.begin(), again.end(), bytes.begin())) std::abort();
  const auto content = bytes.subspan(kThimbleHeaderSize);
  take<ThimbleHello>(content);
  take<ThimbleChallenge>(content);
  take<ThimbleWelcome>(content);
  take<ThimbleRefusal>(content);
  take<ThimbleSample>(content);
  take<ThimbleConstraints>(content);
  take<ThimbleIdle>(content);
  return 0;
}
