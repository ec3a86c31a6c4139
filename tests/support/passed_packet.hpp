#pragma once

#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace thimble::test {

constexpr std::size_t kMostPassed = 8;

// What a peer on a socket may send: any bytes in one packet, with so many open files (/dev/null),
// kMostPassed at most.
inline void send_packet(int socket, std::span<const std::uint8_t> bytes, std::size_t files) {
  static const int null = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  iovec part{const_cast<std::uint8_t*>(bytes.data()), bytes.size()};  // only read
  alignas(cmsghdr) std::array<char, CMSG_SPACE(kMostPassed * sizeof(int))> control{};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  if (files > 0) {
    message.msg_control = control.data();
    message.msg_controllen = CMSG_SPACE(files * sizeof(int));
    cmsghdr* const rights = CMSG_FIRSTHDR(&message);
    rights->cmsg_level = SOL_SOCKET;
    rights->cmsg_type = SCM_RIGHTS;
    rights->cmsg_len = CMSG_LEN(files * sizeof(int));
    for (std::size_t i = 0; i < files; ++i) {
      std::memcpy(CMSG_DATA(rights) + i * sizeof(int), &null, sizeof null);
    }
  }
  static_cast<void>(::sendmsg(socket, &message, MSG_DONTWAIT | MSG_NOSIGNAL));
}

// The lowest number that is free: what is not closed moves it.
inline int lowest_free() {
  const int number = ::dup(0);
  ::close(number);
  return number;
}

}  // namespace thimble::test
