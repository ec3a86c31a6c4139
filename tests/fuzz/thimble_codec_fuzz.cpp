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

// Whatever is taken can be sent, and means the same when it arrives, also where a message stood
// before.
template <class Message>
void take(std::span<const std::byte> content) {
  Message used;
  (void)decode(content.subspan(content.size() / 2), used);
  const bool is_taken_again = decode(content, used).has_value();
  Message message;
  if (decode(content, message).has_value() != is_taken_again) std::abort();
  if (!is_taken_again) return;
  Content first{};
  const auto size = encode(message, first);
  if (!size) std::abort();
  Message again;
  if (!decode(std::span(first).first(*size), again)) std::abort();
  Content second{};
  const auto same_size = encode(again, second);
  if (!same_size || *same_size != *size || first != second) std::abort();
  Content third{};
  const auto used_size = encode(used, third);
  if (!used_size || *used_size != *size || first != third) std::abort();
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
