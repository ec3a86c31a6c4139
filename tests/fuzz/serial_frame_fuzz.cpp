#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "daemon/link/serial_frame.hpp"

// Whatever a line carries, what is found in it is a datagram with its checksum; and what is framed
// behind it is found whole.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thimble::link;
  const auto bytes = std::as_bytes(std::span(data, size));
  Deframer line;
  for (const std::byte byte : bytes) {
    const auto datagram = line.push(byte);
    if (!datagram) continue;
    if (datagram->empty() || datagram->size() > kMaxThimbleDatagram) std::abort();
  }
  const auto sent = bytes.first(std::min(size, kMaxThimbleDatagram));
  if (sent.empty()) return 0;
  std::size_t found = 0;
  const SerialFrame framed = frame(sent);
  for (const std::byte byte : framed.view()) {
    const auto datagram = line.push(byte);
    if (datagram && std::equal(datagram->begin(), datagram->end(), sent.begin(), sent.end())) {
      ++found;
    }
  }
  if (found != 1) std::abort();
  return 0;
}
