#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "daemon/link/udp_arm_link.hpp"
#include "daemon/link/udp_port.hpp"
#include "daemon/link/udp_world_server.hpp"
#include "hal/linux/monotonic_clock.hpp"
#include "tests/unit/link/thesis_1999.hpp"
#include "tests/unit/link/world_double.hpp"

// Real sockets on loopback. Nothing here judges a time: waits are bounded generously, and end
// when what they wait for has happened.
namespace thimble::link {
namespace {

namespace asio = boost::asio;
using asio::ip::udp;
using boost::system::error_code;

Endpoint loopback(std::uint16_t port = 0) {
  Endpoint out;
  out.address = {127, 0, 0, 1};
  out.port = port;
  return out;
}

// A plain blocking socket, as the programs of 1999 had.
class PlainSocket {
 public:
  PlainSocket() : socket_(io_, udp::endpoint(asio::ip::address_v4::loopback(), 0)) {
    const timeval bound{20, 0};  // a blocked test fails instead of hanging
    setsockopt(socket_.native_handle(), SOL_SOCKET, SO_RCVTIMEO, &bound, sizeof bound);
  }
  [[nodiscard]] std::uint16_t port() const { return socket_.local_endpoint().port(); }
  void send(std::uint16_t to, const y1999::Datagram& bytes) {
    socket_.send_to(asio::buffer(bytes), udp::endpoint(asio::ip::address_v4::loopback(), to));
  }
  // Blocks. Empty: nothing came within the bound.
  y1999::Datagram receive(std::uint16_t* from = nullptr) {
    y1999::Datagram bytes(256);
    sockaddr_in sender{};
    socklen_t length = sizeof sender;
    const ssize_t size = recvfrom(socket_.native_handle(), bytes.data(), bytes.size(), 0,
                                  reinterpret_cast<sockaddr*>(&sender), &length);
    bytes.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    if (from != nullptr) *from = ntohs(sender.sin_port);
    return bytes;
  }

 private:
  asio::io_context io_;
  udp::socket socket_;
};

class UdpTest : public ::testing::Test {
 protected:
  bool run_until(const std::function<bool()>& is_done) {
    for (int i = 0; i < 20000; ++i) {
      if (is_done()) return true;
      if (io.stopped()) io.restart();
      io.run_one_for(std::chrono::milliseconds(1));
    }
    return false;
  }
  std::unique_ptr<UdpWorldServer> open_server(std::uint16_t port = 0) {
    auto opened = UdpWorldServer::open(io, clock, {.bind = loopback(port)}, {.of_1999 = &world});
    EXPECT_TRUE(opened.has_value()) << (opened ? "" : opened.error().message);
    return opened ? std::move(*opened) : nullptr;
  }
  std::unique_ptr<UdpArmLink> open_arm(std::uint16_t port, SendMode mode = SendMode::Streamed) {
    auto opened =
        UdpArmLink::open(io, clock, {.peer = loopback(port), .end = {.mode = mode}}, nullptr);
    EXPECT_TRUE(opened.has_value()) << (opened ? "" : opened.error().message);
    return opened ? std::move(*opened) : nullptr;
  }
  // One tick of a servo with the hand at the +x wall.
  void tick(UdpArmLink& arm) {
    arm.arm_end().send({.sequence = ++sequence, .sampled_at = clock.now(), .hand = {0.016, 0, 0}});
    arm.on_wake();
  }

  linux::MonotonicClock clock;
  asio::io_context io{1};
  WorldDouble world;
  std::uint64_t sequence{0};
};

TEST_F(UdpTest, ABlockingClientOf1999IsServed) {
  const auto server = open_server();
  constexpr int kExchanges = 500;
  std::atomic<int> answered{0};
  std::atomic<bool> is_over{false};
  std::thread client([&, port = server->local().port] {
    PlainSocket socket;
    for (int i = 0; i < kExchanges; ++i) {
      socket.send(port, y1999::request(i % 2 == 0 ? 20.0F : 0.0F, 0, -15.5F));
      const y1999::Datagram reply = socket.receive();
      if (reply.size() != 13) break;
      const unsigned directions = i % 2 == 0 ? 0x21U : 0x20U;
      if (std::to_integer<unsigned>(reply[12]) == directions) ++answered;
    }
    is_over = true;
  });
  run_until([&] { return is_over.load(); });
  client.join();
  EXPECT_EQ(answered.load(), kExchanges);
  EXPECT_EQ(world.opened, 1U);
  EXPECT_EQ(server->status().counters.sent, static_cast<std::uint64_t>(kExchanges));
}

TEST_F(UdpTest, DatagramsThatWaitTogetherAreAllReceivedAtBothEnds) {
  constexpr std::uint64_t kBurst = 40;
  const auto server = open_server();
  PlainSocket stranger;
  const y1999::Datagram short_one(5);
  for (std::uint64_t i = 0; i < kBurst; ++i) stranger.send(server->local().port, short_one);
  EXPECT_TRUE(run_until([&] { return server->status().counters.received == kBurst; }));

  PlainSocket peer;
  const auto arm = open_arm(peer.port());
  tick(*arm);
  std::uint16_t arm_port = 0;
  ASSERT_EQ(peer.receive(&arm_port).size(), 12U);
  for (std::uint64_t i = 0; i < kBurst; ++i) stranger.send(arm_port, short_one);
  EXPECT_TRUE(run_until([&] { return arm->status().counters.received == kBurst; }));
}

TEST_F(UdpTest, AnArmTalksToAServerOf1999) {
  for (const SendMode mode : {SendMode::Streamed, SendMode::LockStep}) {
    PlainSocket socket;
    std::atomic<bool> is_over{false};
    std::thread server([&] {
      y1999::Server logic;
      while (!is_over) {
        std::uint16_t from = 0;
        const y1999::Datagram in = socket.receive(&from);
        const y1999::Datagram out = logic.answer(in);
        if (!out.empty()) socket.send(from, out);
      }
    });
    const auto arm = open_arm(socket.port(), mode);
    int received = 0;
    run_until([&] {
      tick(*arm);
      coupling::ConstraintSet reply;
      if (arm->arm_end().receive(reply) && reply.planes.size() == 1 &&
          reply.planes[0].offset_m == 0.015) {
        ++received;
      }
      return received >= 50;
    });
    is_over = true;
    PlainSocket().send(socket.port(), y1999::request(0, 0, 0));  // wakes the blocked server
    server.join();
    EXPECT_GE(received, 50);
    EXPECT_TRUE(arm->arm_end().quality().is_up);
    EXPECT_EQ(arm->status().counters.rejected(), 0U);
  }
}

TEST_F(UdpTest, BothOursMeetAndCount) {
  const auto server = open_server();
  const auto arm = open_arm(server->local().port);
  coupling::ConstraintSet reply;
  ASSERT_TRUE(run_until([&] {
    tick(*arm);
    arm->arm_end().receive(reply);
    return reply.sequence >= 100;
  }));
  EXPECT_EQ(reply.session, 1U);
  EXPECT_EQ(reply.planes.size(), 1U);
  EXPECT_EQ(arm->status().peer, to_string(server->local()));
  EXPECT_GT(arm->status().round_trip, Duration::zero());
  EXPECT_GE(server->status().counters.accepted, 100U);
  EXPECT_TRUE(server->status().is_up);
}

TEST_F(UdpTest, InjectedDelayIsServedByTheTimer) {
  auto opened = UdpWorldServer::open(
      io, clock, {.bind = loopback(), .end = {.impairment = {.delay_s = 0.02, .jitter_s = 0.01}}},
      {.of_1999 = &world});
  ASSERT_TRUE(opened.has_value());
  PlainSocket client;
  for (int i = 0; i < 20; ++i) {
    client.send((*opened)->local().port, y1999::request(0, 0, 0));
  }
  ASSERT_TRUE(run_until([&] { return (*opened)->status().counters.sent == 20; }));
  for (int i = 0; i < 20; ++i) EXPECT_EQ(client.receive().size(), 13U);
}

TEST_F(UdpTest, APeerWhereNobodyListensIsCountedAndFoundWhenItStarts) {
  std::uint16_t port = 0;
  {
    const PlainSocket reserved;
    port = reserved.port();
  }
  const auto arm = open_arm(port);
  ASSERT_TRUE(run_until([&] {
    tick(*arm);
    const LinkCounters counters = arm->status().counters;
    return counters.send_errors + counters.receive_errors >= 2;
  }));
  EXPECT_FALSE(arm->arm_end().quality().is_up);
  EXPECT_NE(arm->status().last_error.find("refused"), std::string::npos);
  const auto server = open_server(port);
  EXPECT_TRUE(run_until([&] {
    tick(*arm);
    return arm->arm_end().quality().is_up;
  }));
}

class SteppedClock final : public Clock {
 public:
  [[nodiscard]] MonotonicTime now() const noexcept override { return now_; }
  Duration sleep_until(MonotonicTime deadline) noexcept override {
    now_ = deadline;
    return {};
  }

 private:
  MonotonicTime now_{std::chrono::seconds(1)};
};

// A stream does not wait for replies: without a pause every tick would fail.
TEST_F(UdpTest, AStreamWhosePeerIsGoneIsTriedAgainAfterPausesThatGrow) {
  auto server = open_server();
  SteppedClock stepped;
  const auto arm = UdpArmLink::open(io, stepped, {.peer = loopback(server->local().port)}, nullptr);
  ASSERT_TRUE(arm);
  const auto step = [&] {
    tick(**arm);
    stepped.sleep_until(stepped.now() + std::chrono::milliseconds(1));
  };
  ASSERT_TRUE(run_until([&] {
    step();
    return (*arm)->status().is_up;
  }));
  server.reset();
  // Silence ends the stream after 1 s, and what asks from then on is slower anyhow.
  for (int ms = 0; ms < 900; ++ms) {
    step();
    io.restart();
    io.poll();
  }
  EXPECT_TRUE((*arm)->status().is_up);
  const LinkCounters counters = (*arm)->status().counters;
  // After 0, 10, 30, 70 and 150 ms, then every 100 ms; each may be told twice, by what is sent and
  // by what is received.
  EXPECT_LE(counters.send_errors + counters.receive_errors, 2U * 13U);
  EXPECT_GT(counters.send_errors + counters.receive_errors, 0U);
}

TEST_F(UdpTest, AnArmRefusesDatagramsOfOthers) {
  const auto server = open_server();
  const auto arm = open_arm(server->local().port);
  ASSERT_TRUE(run_until([&] {
    tick(*arm);
    return server->status().is_up && arm->arm_end().quality().is_up;
  }));
  const std::string arm_peer = server->status().peer;
  const std::uint16_t arm_port = parse_endpoint(arm_peer)->port;
  PlainSocket stranger;
  y1999::Datagram forged = y1999::request(-99, -99, -99);
  forged.push_back(std::byte{0x2A});
  for (int i = 0; i < 10; ++i) stranger.send(arm_port, forged);
  ASSERT_TRUE(
      run_until([&] { return arm->status().counters.rejected(RejectReason::WrongPeer) == 10; }));
  tick(*arm);
  EXPECT_TRUE(arm->arm_end().quality().is_up);
}

TEST_F(UdpTest, AServerCountsHostileDatagramsAndOpensNothing) {
  const auto server = open_server();
  PlainSocket stranger;
  std::uint64_t sent = 0;
  for (std::size_t size = 0; size <= 200; ++size) {
    if (size == 12) continue;
    stranger.send(server->local().port, y1999::Datagram(size));
    ++sent;
    ASSERT_TRUE(run_until([&] { return server->status().counters.received == sent; }));
  }
  EXPECT_EQ(server->status().counters.rejected(RejectReason::WrongSize), sent);
  EXPECT_EQ(world.opened, 0U);
  EXPECT_EQ(server->status().counters.sent, 0U);
}

TEST_F(UdpTest, AServerThatReturnsBeginsANewSessionForTheArm) {
  auto server = open_server();
  const std::uint16_t port = server->local().port;
  const auto arm = open_arm(port);
  const auto is_up = [&] {
    tick(*arm);
    return arm->arm_end().quality().is_up;
  };
  ASSERT_TRUE(run_until(is_up));
  server.reset();
  EXPECT_FALSE(world.is_open);
  ASSERT_TRUE(run_until([&] { return !is_up(); }));
  server = open_server(port);
  ASSERT_TRUE(run_until(is_up));
  coupling::ConstraintSet reply;
  ASSERT_TRUE(run_until([&] {
    tick(*arm);
    return arm->arm_end().receive(reply) && reply.session == 2;
  }));
}

TEST_F(UdpTest, AListenerOfBothFamiliesKnowsItsIpv4Peer) {
  Endpoint any;
  any.is_v6 = true;
  Endpoint pinned = loopback();
  const auto open_for = [&] {
    return UdpWorldServer::open(
        io, clock, {.bind = any, .allow_unauthenticated = true, .end = {.pinned_peer = pinned}},
        {.of_1999 = &world});
  };
  PlainSocket client;
  {
    const auto opened = open_for();
    if (!opened) GTEST_SKIP() << "this machine has no IPv6: " << opened.error().message;
    client.send((*opened)->local().port, y1999::request(20, 0, 0));
    ASSERT_TRUE(run_until([&] { return (*opened)->status().counters.received == 1; }));
    EXPECT_EQ(client.receive().size(), 13U);
  }
  pinned.address = {127, 0, 0, 2};
  const auto opened = open_for();
  ASSERT_TRUE(opened.has_value());
  client.send((*opened)->local().port, y1999::request(20, 0, 0));
  ASSERT_TRUE(run_until([&] { return (*opened)->status().counters.received == 1; }));
  EXPECT_EQ((*opened)->status().counters.rejected(RejectReason::WrongPeer), 1U);
}

TEST_F(UdpTest, SaysClearlyWhyItCannotListenOrLink) {
  const auto server = open_server();
  const auto second = UdpWorldServer::open(io, clock, {.bind = loopback(server->local().port)},
                                           {.of_1999 = &world});
  ASSERT_FALSE(second.has_value());
  EXPECT_EQ(second.error().code, Errc::Busy);
  EXPECT_NE(second.error().message.find("another program already listens on udp://127.0.0.1:"),
            std::string::npos);
  const auto open_to_all =
      UdpWorldServer::open(io, clock, {.bind = Endpoint{}}, {.of_1999 = &world});
  ASSERT_FALSE(open_to_all.has_value());
  EXPECT_EQ(open_to_all.error().code, Errc::Permission);
  Endpoint elsewhere;
  elsewhere.address = {192, 0, 2, 1};  // RFC 5737: nobody's
  UdpPort port(io);
  const auto bound = port.open(elsewhere);
  ASSERT_FALSE(bound.has_value());
  EXPECT_EQ(bound.error().code, Errc::System);
  EXPECT_TRUE(bound.error().message.starts_with("cannot bind udp://192.0.2.1:0: "))
      << bound.error().message;
  Endpoint far = loopback(5001);
  far.address = {10, 0, 0, 7};
  const auto arm = UdpArmLink::open(io, clock, {.peer = far}, nullptr);
  ASSERT_FALSE(arm.has_value());
  EXPECT_EQ(arm.error().code, Errc::Permission);
}

TEST_F(UdpTest, MayBeDestroyedWhileTheLoopStillHoldsItsHandlers) {
  {
    const auto server = open_server();
    const auto arm = open_arm(server->local().port);
    tick(*arm);
  }
  EXPECT_FALSE(world.is_open);
  io.restart();
  io.run_for(std::chrono::milliseconds(5));
  EXPECT_EQ(world.answered_while_closed, 0U);
}

}  // namespace
}  // namespace thimble::link
