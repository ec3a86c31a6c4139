#include "guard/handover.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>

#include <cstring>
#include <random>
#include <string>

#include "tests/support/passed_packet.hpp"

namespace thimble::guard {
namespace {

using linux::Descriptor;

Handover some_handover(std::mt19937& random) {
  Handover handover;
  handover.route = static_cast<ZeroRoute>(random() % 3);
  handover.endpoint = static_cast<std::uint8_t>(random());
  handover.size = 1 + random() % kMaxZeroBytes;
  for (std::size_t i = 0; i < handover.size; ++i) {
    handover.bytes[i] = static_cast<std::uint8_t>(random());
  }
  return handover;
}

class Sockets {
 public:
  Sockets() {
    std::array<int, 2> ends{};
    if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) ADD_FAILURE();
    daemon = Descriptor(ends[0]);
    guard = Descriptor(ends[1]);
  }
  Descriptor daemon;
  Descriptor guard;
};

Descriptor null_device() { return Descriptor(::open("/dev/null", O_RDWR | O_CLOEXEC)); }

std::string refusal(const Result<Received>& received) {
  return received ? "" : received.error().message;
}

TEST(Handover, IsReadAsItWasWritten) {
  std::mt19937 random(3);
  for (int i = 0; i < 1000; ++i) {
    const Handover handover = some_handover(random);
    EXPECT_EQ(parse_handover(encode(handover)), handover);
  }
}

TEST(Handover, AnyBytesAreReadOrRefusedAndWhatIsReadIsWrittenAlike) {
  std::mt19937 random(5);
  int read = 0;
  for (int i = 0; i < 20'000; ++i) {
    std::vector<std::uint8_t> packet = encode(some_handover(random));
    const std::size_t changes = random() % 3;
    for (std::size_t c = 0; c < changes; ++c) {
      packet[random() % 8 % packet.size()] = static_cast<std::uint8_t>(random() % 4);
    }
    packet.resize(random() % 4 == 0 ? random() % 80 : packet.size());
    const auto handover = parse_handover(packet);
    if (!handover) continue;
    ++read;
    EXPECT_EQ(encode(*handover), packet);
    EXPECT_LE(handover->size, kMaxZeroBytes);
  }
  EXPECT_GT(read, 1000);
}

TEST(Handover, SaysWhatIsWrongWithAPacket) {
  const std::vector<std::uint8_t> good = encode({ZeroRoute::Write, 0, 1, {}});
  EXPECT_EQ(parse_handover({}).error().message, "handover: expected 6 to 70 bytes, found 0");
  auto version = good;
  version[2] = 0;
  EXPECT_EQ(parse_handover(version).error().message, "handover: not one of version 2");
  auto route = good;
  route[3] = 3;
  EXPECT_EQ(parse_handover(route).error().message, "handover: there is no route 3");
}

TEST(HandoverDeathTest, OfMoreBytesThanItHasIsNeverReadNorSent) {
  Handover handover;
  handover.size = kMaxZeroBytes;
  EXPECT_EQ(parse_handover(encode(handover)), handover);
  handover.size = kMaxZeroBytes + 1;
  const std::string broken = "broken invariant: size <= kMaxZeroBytes";
  EXPECT_DEATH(static_cast<void>(handover.zero()), broken);
  EXPECT_DEATH(static_cast<void>(encode(handover)), broken);
  EXPECT_DEATH(static_cast<void>(send_handover(-1, handover, -1, -1)), broken);
}

TEST(Handover, BringsItsDescriptorsAndTheyAreNotInherited) {
  const Sockets sockets;
  const Descriptor node = null_device();
  const Descriptor page = null_device();
  std::mt19937 random(9);
  for (int i = 0; i < 20; ++i) {
    const Handover handover = some_handover(random);
    ASSERT_TRUE(send_handover(sockets.daemon.get(), handover, node.get(), page.get()).has_value());
    const auto received = receive_handover(sockets.guard.get(), 1000);
    ASSERT_TRUE(received.has_value()) << refusal(received);
    EXPECT_EQ(received->handover, handover);
    for (const int fd : {received->node.get(), received->page.get()}) {
      EXPECT_GE(fd, 0);
      EXPECT_EQ(::fcntl(fd, F_GETFD), FD_CLOEXEC);
    }
  }
}

// Which is which: told apart by what each is open for.
TEST(Handover, EachDescriptorComesAsWhatItWasSent) {
  const Sockets sockets;
  const Descriptor node(::open("/dev/null", O_WRONLY | O_CLOEXEC));
  const Descriptor page = null_device();
  const Handover handover{ZeroRoute::Hiddev, 0, 2, {}};
  ASSERT_TRUE(send_handover(sockets.daemon.get(), handover, node.get(), page.get()).has_value());
  const auto received = receive_handover(sockets.guard.get(), 1000);
  ASSERT_TRUE(received.has_value()) << refusal(received);
  const auto mode = [](const Descriptor& fd) { return ::fcntl(fd.get(), F_GETFL) & O_ACCMODE; };
  EXPECT_EQ(mode(received->node), O_WRONLY);
  EXPECT_EQ(mode(received->page), O_RDWR);
}

TEST(Handover, WithoutBothDescriptorsIsRefused) {
  const Sockets sockets;
  const auto packet = encode({ZeroRoute::Write, 0, 1, {}});
  ASSERT_GT(::send(sockets.daemon.get(), packet.data(), packet.size(), 0), 0);
  EXPECT_EQ(refusal(receive_handover(sockets.guard.get(), 1000)),
            "handover: expected 2 descriptors, found 0");
}

TEST(Handover, WithMoreOrFewerDescriptorsIsRefused) {
  const Sockets sockets;
  const auto packet = encode({ZeroRoute::Write, 0, 1, {}});
  for (const std::size_t count : {1U, 3U}) {
    test::send_packet(sockets.daemon.get(), packet, count);
    EXPECT_EQ(refusal(receive_handover(sockets.guard.get(), 1000)),
              "handover: expected 2 descriptors, found " + std::to_string(count));
  }
}

TEST(Handover, OfAPacketThatIsRefusedTheDescriptorsAreClosed) {
  const Sockets sockets;
  std::array<int, 2> pipe{};
  ASSERT_EQ(::pipe2(pipe.data(), O_CLOEXEC | O_NONBLOCK), 0);
  const Descriptor out(pipe[0]);
  Handover none;  // no bytes at all: refused
  {
    const Descriptor in(pipe[1]);
    ASSERT_TRUE(send_handover(sockets.daemon.get(), none, in.get(), in.get()).has_value());
  }
  EXPECT_NE(refusal(receive_handover(sockets.guard.get(), 1000)), "");
  char byte = 0;
  EXPECT_EQ(::read(out.get(), &byte, 1), 0) << "nobody holds the other end any more";
}

// A packet of no bytes reads like the end of the connection, and may still bring descriptors.
TEST(Handover, OfAnEmptyPacketTheDescriptorsAreClosed) {
  const Sockets sockets;
  std::array<int, 2> pipe{};
  ASSERT_EQ(::pipe2(pipe.data(), O_CLOEXEC | O_NONBLOCK), 0);
  const Descriptor out(pipe[0]);
  {
    const Descriptor in(pipe[1]);
    alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> control{};
    msghdr message{};
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    cmsghdr* const rights = CMSG_FIRSTHDR(&message);
    rights->cmsg_level = SOL_SOCKET;
    rights->cmsg_type = SCM_RIGHTS;
    rights->cmsg_len = CMSG_LEN(sizeof(int));
    const int sent = in.get();
    std::memcpy(CMSG_DATA(rights), &sent, sizeof sent);
    ASSERT_EQ(::sendmsg(sockets.daemon.get(), &message, 0), 0);
  }
  EXPECT_NE(refusal(receive_handover(sockets.guard.get(), 1000)), "");
  char byte = 0;
  EXPECT_EQ(::read(out.get(), &byte, 1), 0) << "nobody holds the other end any more";
}

TEST(Handover, ADaemonThatSaysNothingOrGoesIsNamed) {
  Sockets sockets;
  EXPECT_EQ(refusal(receive_handover(sockets.guard.get(), 1)), "no arm was handed over");
  sockets.daemon = Descriptor();
  EXPECT_EQ(receive_handover(sockets.guard.get(), 1000).error().code, Errc::Disconnected);
}

}  // namespace
}  // namespace thimble::guard
