#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "guard/handover.hpp"
#include "hal/base/check.hpp"
#include "tests/support/passed_packet.hpp"

using namespace thimble;

// Whatever packet comes, with however many descriptors: it is refused, or has its two, and none
// stays open. The first byte: how many; the rest is the packet.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  std::array<int, 2> ends{};
  THIMBLE_CHECK(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) == 0);
  const std::size_t descriptors = data[0] % (test::kMostPassed + 1);
  test::send_packet(ends[0], {data + 1, size - 1}, descriptors);
  ::close(ends[0]);
  const int free_before = test::lowest_free();
  {
    const auto received = guard::receive_handover(ends[1], 1000);
    if (received) {
      THIMBLE_CHECK(descriptors == 2);
      THIMBLE_CHECK(received->node.get() >= 0 && received->page.get() >= 0);
      const std::vector<std::uint8_t> again = guard::encode(received->handover);
      THIMBLE_CHECK(std::ranges::equal(again, std::span(data + 1, size - 1)));
    } else {
      THIMBLE_CHECK(!received.error().message.empty());
    }
  }
  THIMBLE_CHECK(test::lowest_free() == free_before);
  ::close(ends[1]);
  return 0;
}
