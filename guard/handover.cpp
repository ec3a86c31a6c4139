#include "guard/handover.hpp"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <optional>
#include <string>

#include "hal/linux/passed_descriptors.hpp"
#include "hal/linux/system_error.hpp"

namespace thimble::guard {
namespace {

constexpr std::array<std::uint8_t, 3> kMark{'T', 'G', 2};
constexpr std::size_t kHead = kMark.size() + 2;
constexpr std::size_t kDescriptors = 2;

// Room for one packet, one more byte and one more descriptor, so that more are seen to be more.
struct Packet {
  std::array<std::uint8_t, kHead + kMaxZeroBytes + 1> bytes{};
  alignas(cmsghdr) std::array<char, CMSG_SPACE((kDescriptors + 1) * sizeof(int))> control{};
  iovec part{};
  msghdr message{};

  Packet() {
    part = {bytes.data(), bytes.size()};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
  }
  Packet(const Packet&) = delete;
  Packet& operator=(const Packet&) = delete;
};

}  // namespace

std::vector<std::uint8_t> encode(const Handover& handover) {
  std::vector<std::uint8_t> packet(kMark.begin(), kMark.end());
  packet.push_back(static_cast<std::uint8_t>(handover.route));
  packet.push_back(handover.endpoint);
  const auto zero = handover.zero();
  packet.insert(packet.end(), zero.begin(), zero.end());
  return packet;
}

Result<Handover> parse_handover(std::span<const std::uint8_t> packet) {
  if (packet.size() <= kHead || packet.size() > kHead + kMaxZeroBytes) {
    return fail(Errc::Malformed,
                "handover: expected 6 to 70 bytes, found " + std::to_string(packet.size()));
  }
  if (!std::equal(kMark.begin(), kMark.end(), packet.begin())) {
    return fail(Errc::Malformed, "handover: not one of version 2");
  }
  if (packet[kMark.size()] > static_cast<std::uint8_t>(ZeroRoute::Hiddev)) {
    return fail(Errc::Malformed,
                "handover: there is no route " + std::to_string(packet[kMark.size()]));
  }
  Handover handover;
  handover.route = static_cast<ZeroRoute>(packet[kMark.size()]);
  handover.endpoint = packet[kMark.size() + 1];
  handover.size = packet.size() - kHead;
  std::copy(packet.begin() + kHead, packet.end(), handover.bytes.begin());
  return handover;
}

Result<void> send_handover(int socket, const Handover& handover, int node, int page) {
  Packet packet;
  const std::vector<std::uint8_t> bytes = encode(handover);
  std::copy(bytes.begin(), bytes.end(), packet.bytes.begin());
  packet.part.iov_len = bytes.size();
  cmsghdr* const rights = CMSG_FIRSTHDR(&packet.message);
  rights->cmsg_level = SOL_SOCKET;
  rights->cmsg_type = SCM_RIGHTS;
  const std::array<int, kDescriptors> descriptors{node, page};
  constexpr std::size_t kSize = sizeof descriptors;
  rights->cmsg_len = CMSG_LEN(kSize);
  packet.message.msg_controllen = CMSG_SPACE(kSize);
  std::memcpy(CMSG_DATA(rights), descriptors.data(), kSize);
  if (::sendmsg(socket, &packet.message, MSG_NOSIGNAL | MSG_DONTWAIT) < 0) {
    return tl::unexpected(linux::system_error("cannot hand the arm over", errno));
  }
  return {};
}

Result<Received> receive_handover(int socket, int timeout_ms) {
  pollfd readable{socket, POLLIN, 0};
  const int ready = ::poll(&readable, 1, timeout_ms);
  if (ready < 0) return tl::unexpected(linux::system_error("cannot wait for an arm", errno));
  if (ready == 0) return fail(Errc::Timeout, "no arm was handed over");
  Packet packet;
  const ssize_t size = ::recvmsg(socket, &packet.message, MSG_DONTWAIT | MSG_CMSG_CLOEXEC);
  if (size < 0) return tl::unexpected(linux::system_error("cannot be handed an arm", errno));
  // Of an empty packet, too: what came with it would stay open.
  std::vector<linux::Descriptor> descriptors = linux::take_descriptors(packet.message);
  if (size == 0) return fail(Errc::Disconnected, "no arm was handed over");
  auto handover = parse_handover({packet.bytes.data(), static_cast<std::size_t>(size)});
  if (!handover) return tl::unexpected(handover.error());
  if (descriptors.size() != kDescriptors || (packet.message.msg_flags & MSG_CTRUNC) != 0) {
    return fail(Errc::Malformed, "handover: expected " + std::to_string(kDescriptors) +
                                     " descriptors, found " + std::to_string(descriptors.size()));
  }
  return Received{*handover, std::move(descriptors[0]), std::move(descriptors[1])};
}

}  // namespace thimble::guard
