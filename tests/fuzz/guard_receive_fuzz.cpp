#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "guard/handover.hpp"
#include "hal/base/check.hpp"

namespace {

using namespace thimble;

constexpr std::size_t kMostSent = 8;  // a handover has 2 or 3

// In one packet, with so many descriptors of /dev/null.
void send(int socket, std::span<const std::uint8_t> packet, std::size_t descriptors) {
  static const int null = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  iovec part{const_cast<std::uint8_t*>(packet.data()), packet.size()};  // only read
  alignas(cmsghdr) std::array<char, CMSG_SPACE(kMostSent * sizeof(int))> control{};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  if (descriptors > 0) {
    message.msg_control = control.data();
    message.msg_controllen = CMSG_SPACE(descriptors * sizeof(int));
    cmsghdr* const rights = CMSG_FIRSTHDR(&message);
    rights->cmsg_level = SOL_SOCKET;
    rights->cmsg_type = SCM_RIGHTS;
    rights->cmsg_len = CMSG_LEN(descriptors * sizeof(int));
    for (std::size_t i = 0; i < descriptors; ++i) {
      std::memcpy(CMSG_DATA(rights) + i * sizeof(int), &null, sizeof null);
    }
  }
  static_cast<void>(::sendmsg(socket, &message, MSG_DONTWAIT | MSG_NOSIGNAL));
}

// The lowest number that is free: what is not closed moves it.
int lowest_free() {
  const int number = ::dup(0);
  ::close(number);
  return number;
}

}  // namespace

// Whatever packet comes, with however many descriptors: it is refused, or has those that its route
// needs, and none stays open. The first byte: how many; the rest is the packet.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  std::array<int, 2> ends{};
  THIMBLE_CHECK(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) == 0);
  const std::size_t descriptors = data[0] % (kMostSent + 1);
  send(ends[0], {data + 1, size - 1}, descriptors);
  ::close(ends[0]);
  const int free_before = lowest_free();
  {
    const auto received = guard::receive_handover(ends[1], 1000);
    if (received) {
      const bool has_second = received->handover.route == guard::ZeroRoute::HiddevAndWrite;
      THIMBLE_CHECK(descriptors == (has_second ? 3U : 2U));
      THIMBLE_CHECK(received->device.node.get() >= 0 && received->page.get() >= 0);
      THIMBLE_CHECK((received->device.hiddev.get() >= 0) == has_second);
      const std::vector<std::uint8_t> again = guard::encode(received->handover);
      THIMBLE_CHECK(std::ranges::equal(again, std::span(data + 1, size - 1)));
    } else {
      THIMBLE_CHECK(!received.error().message.empty());
    }
  }
  THIMBLE_CHECK(lowest_free() == free_before);
  ::close(ends[1]);
  return 0;
}
