#include "hal/linux/passed_descriptors.hpp"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "hal/linux/system_error.hpp"

namespace thimble::linux {
namespace {

constexpr std::size_t kRoomFor = 2;       // one more, so that more are seen to be more
constexpr int kMostPatience_ms = 60'000;  // ours: who needs longer does not answer at all

struct OneByte {
  char byte{0};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(kRoomFor * sizeof(int))> control{};
  iovec part{&byte, sizeof(byte)};
  msghdr message{};

  explicit OneByte(std::size_t control_bytes) {
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control_bytes;
  }
  OneByte(const OneByte&) = delete;
  OneByte& operator=(const OneByte&) = delete;
};

}  // namespace

std::vector<Descriptor> take_descriptors(msghdr& message) {
  std::vector<Descriptor> all;
  for (cmsghdr* part = CMSG_FIRSTHDR(&message); part != nullptr;
       part = CMSG_NXTHDR(&message, part)) {
    if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SCM_RIGHTS) continue;
    const std::size_t count = (part->cmsg_len - CMSG_LEN(0)) / sizeof(int);
    for (std::size_t i = 0; i < count; ++i) {
      int fd = -1;
      std::memcpy(&fd, CMSG_DATA(part) + i * sizeof(int), sizeof(int));
      all.emplace_back(fd);
    }
  }
  return all;
}

Result<void> send_descriptor(int socket, const Descriptor& file) {
  OneByte packet(CMSG_SPACE(sizeof(int)));
  cmsghdr* const rights = CMSG_FIRSTHDR(&packet.message);
  rights->cmsg_level = SOL_SOCKET;
  rights->cmsg_type = SCM_RIGHTS;
  rights->cmsg_len = CMSG_LEN(sizeof(int));
  const int fd = file.get();
  std::memcpy(CMSG_DATA(rights), &fd, sizeof(fd));
  if (::sendmsg(socket, &packet.message, MSG_NOSIGNAL | MSG_DONTWAIT) < 0) {
    return tl::unexpected(system_error("cannot pass an open file on", errno));
  }
  return {};
}

Result<Descriptor> receive_descriptor(int socket, Duration patience) {
  pollfd readable{socket, POLLIN, 0};
  // To poll(2) less than nothing is for ever.
  const auto patience_ms = std::chrono::duration_cast<std::chrono::milliseconds>(patience).count();
  const auto bounded_ms = std::clamp<decltype(patience_ms)>(patience_ms, 0, kMostPatience_ms);
  const int ready = ::poll(&readable, 1, static_cast<int>(bounded_ms));
  if (ready < 0) return tl::unexpected(system_error("cannot wait for an open file", errno));
  if (ready == 0) return fail(Errc::Timeout, "no open file was passed on in time");
  OneByte packet(CMSG_SPACE(kRoomFor * sizeof(int)));
  const ssize_t size = ::recvmsg(socket, &packet.message, MSG_DONTWAIT | MSG_CMSG_CLOEXEC);
  if (size < 0) return tl::unexpected(system_error("no open file was passed on", errno));
  // Of an empty packet, too: what came with it would stay open.
  std::vector<Descriptor> files = take_descriptors(packet.message);
  if (size == 0 && files.empty()) return fail(Errc::Disconnected, "no open file was passed on");
  const bool is_cut = (packet.message.msg_flags & (MSG_TRUNC | MSG_CTRUNC)) != 0;
  if (size != 1 || is_cut || files.size() != 1) {
    return fail(Errc::Malformed, "expected one open file, something else was passed on");
  }
  return std::move(files.front());
}

}  // namespace thimble::linux
