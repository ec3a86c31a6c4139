#include "lab/run/virtual_network.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace thimble::lab {
namespace {

using link::DatagramPort;
using link::Endpoint;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

Endpoint at(const char* text) { return link::parse_endpoint(text).value(); }

std::vector<std::byte> bytes_of(const std::string& text) {
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  return {first, first + text.size()};
}

// A port that keeps what it hears: "words from udp://…".
struct Ear {
  Ear(VirtualNetwork& network, std::size_t host, const Endpoint& bind)
      : port(network.host(host).make_port()) {
    EXPECT_TRUE(port->open(bind));
    port->start({.on_datagram =
                     [this](const Endpoint& from, std::span<const std::byte> bytes) {
                       longest = std::max(longest, bytes.size());
                       heard.push_back(
                           std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()) +
                           " from " + to_string(from));
                       if (answer) answer(from);
                     },
                 .on_receive_error = [this] { ++refusals; },
                 .on_timer = [this] { ++rings; }});
  }
  void send(const Endpoint& to, const std::string& words) {
    EXPECT_EQ(port->send(to, bytes_of(words)), DatagramPort::Outcome::Done);
  }

  std::unique_ptr<DatagramPort> port;
  std::vector<std::string> heard{};
  std::function<void(const Endpoint& from)> answer{};
  std::size_t longest{0};
  int refusals{0};
  int rings{0};
};

struct VirtualNetworkTest : ::testing::Test {
  VirtualNetwork sut{{at("udp://10.0.0.1:0"), at("udp://10.0.0.2:0")}};
  MonotonicTime now{std::chrono::seconds(1)};
};

TEST_F(VirtualNetworkTest, CarriesInTheNextPassAndInOrder) {
  Ear world(sut, 0, at("udp://0.0.0.0:5001"));
  Ear arm(sut, 1, at("udp://0.0.0.0:0"));
  arm.send(at("udp://10.0.0.1:5001"), "one");
  arm.send(at("udp://10.0.0.1:5001"), "two");
  EXPECT_THAT(world.heard, IsEmpty());
  sut.pass(now);
  EXPECT_THAT(world.heard,
              ElementsAre("one from udp://10.0.0.2:49152", "two from udp://10.0.0.2:49152"));
  sut.pass(now);
  EXPECT_EQ(world.heard.size(), 2U);
}

TEST_F(VirtualNetworkTest, CarriesTheAnswerInTheSamePass) {
  Ear world(sut, 0, at("udp://0.0.0.0:5001"));
  Ear arm(sut, 1, at("udp://0.0.0.0:0"));
  world.answer = [&](const Endpoint& from) { world.send(from, "told"); };
  arm.send(at("udp://10.0.0.1:5001"), "asked");
  sut.pass(now);
  EXPECT_THAT(arm.heard, ElementsAre("told from udp://10.0.0.1:5001"));
}

TEST_F(VirtualNetworkTest, TwoThatAnswerEachOtherForEverDoNotHoldTheTime) {
  Ear one(sut, 0, at("udp://127.0.0.1:1"));
  Ear other(sut, 1, at("udp://127.0.0.1:2"));
  one.answer = [&](const Endpoint& from) { one.send(from, "a"); };
  other.answer = [&](const Endpoint& from) { other.send(from, "b"); };
  one.send(at("udp://127.0.0.1:2"), "a");
  sut.pass(now);
  EXPECT_EQ(one.heard.size() + other.heard.size(), VirtualNetwork::kMostRounds);
}

TEST_F(VirtualNetworkTest, WhoHasTheAddressIsMeant) {
  Ear first(sut, 0, at("udp://0.0.0.0:5001"));
  Ear second(sut, 1, at("udp://0.0.0.0:5001"));
  Ear exact(sut, 0, at("udp://10.0.0.1:5001"));
  Ear from(sut, 0, at("udp://127.0.0.1:0"));
  from.send(at("udp://10.0.0.1:5001"), "exact");
  from.send(at("udp://10.0.0.2:5001"), "second");
  from.send(at("udp://192.0.2.1:5001"), "first of any");
  sut.pass(now);
  EXPECT_EQ(exact.heard.size(), 1U);
  EXPECT_EQ(second.heard.size(), 1U);
  EXPECT_EQ(first.heard.size(), 1U);
}

TEST_F(VirtualNetworkTest, RefusesWhatNobodyListensFor) {
  Ear arm(sut, 0, at("udp://127.0.0.1:0"));
  arm.send(at("udp://127.0.0.1:5001"), "asked");
  sut.pass(now);
  EXPECT_EQ(arm.refusals, 1);
  EXPECT_EQ(arm.port->last_error(), "receive: nobody listens there");
}

TEST_F(VirtualNetworkTest, APortThatIsGoneHearsNothingAndIsFreeAgain) {
  Ear arm(sut, 0, at("udp://127.0.0.1:0"));
  {
    Ear gone(sut, 1, at("udp://127.0.0.1:5001"));
    arm.send(at("udp://127.0.0.1:5001"), "late");
    gone.send(at("udp://127.0.0.1:9"), "to nobody");
    gone.port->wake_after(now, {});
  }
  sut.pass(now);
  EXPECT_EQ(arm.refusals, 1);
  Ear next(sut, 1, at("udp://127.0.0.1:5001"));
  EXPECT_THAT(next.heard, IsEmpty());
}

TEST_F(VirtualNetworkTest, AnAddressHasOnePort) {
  Ear first(sut, 0, at("udp://127.0.0.1:5001"));
  const auto second = sut.host(1).make_port();
  const auto opened = second->open(at("udp://127.0.0.1:5001"));
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, Errc::Busy);
}

TEST_F(VirtualNetworkTest, CutsWhatIsTooLong) {
  Ear world(sut, 0, at("udp://127.0.0.1:5001"));
  Ear arm(sut, 1, at("udp://127.0.0.1:0"));
  arm.send(at("udp://127.0.0.1:5001"), std::string(5000, 'x'));
  sut.pass(now);
  EXPECT_EQ(world.longest, DatagramPort::kMaxDatagram + 1);
}

TEST_F(VirtualNetworkTest, TheEarlierOfTwoWakesCounts) {
  Ear arm(sut, 0, at("udp://127.0.0.1:0"));
  EXPECT_FALSE(sut.due());
  arm.port->wake_after(now, std::chrono::milliseconds(5));
  arm.port->wake_after(now, std::chrono::milliseconds(2));
  arm.port->wake_after(now, std::chrono::milliseconds(9));
  EXPECT_EQ(sut.due(), now + std::chrono::milliseconds(2));
  sut.pass(now + std::chrono::milliseconds(1));
  EXPECT_EQ(arm.rings, 0);
  sut.pass(now + std::chrono::milliseconds(2));
  EXPECT_EQ(arm.rings, 1);
  EXPECT_FALSE(sut.due());
}

}  // namespace
}  // namespace thimble::lab
