#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <vector>

#include "daemon/link/udp_arm_link.hpp"
#include "daemon/link/udp_world_server.hpp"
#include "hal/linux/monotonic_clock.hpp"
#include "tests/unit/link/thimble_table.hpp"

// Our own datagrams through real sockets on loopback, beside those of 1999. Nothing here judges a
// time: waits are bounded generously, and end when what they wait for has happened.
namespace thimble::link {
namespace {

using on_table::key_of;

class UdpThimbleTest : public ::testing::Test {
 protected:
  bool run_until(const std::function<bool()>& is_done) {
    for (int i = 0; i < 20000; ++i) {
      if (is_done()) return true;
      if (io.stopped()) io.restart();
      for (auto& arm : arms) {
        arm->arm_end().send(
            {.sequence = ++sequence, .sampled_at = clock.now(), .hand = {0.016, 0, 0}});
        arm->on_wake();
      }
      io.run_one_for(std::chrono::milliseconds(1));
    }
    return false;
  }
  void open_server(UdpWorldServer::Settings settings) {
    settings.bind.address = {127, 0, 0, 1};
    auto opened = UdpWorldServer::open(io, clock, settings,
                                       {.of_1999 = &world_of_1999, .make_half = make_half()});
    ASSERT_TRUE(opened.has_value()) << opened.error().message;
    server = *std::move(opened);
  }
  ThimbleWorldEnd::MakeHalf make_half() {
    return [this](const ThimbleHalf&) -> Result<std::unique_ptr<coupling::WorldCoupling>> {
      worlds.push_back(std::make_unique<WorldDouble>());
      return std::make_unique<on_table::Half>(*worlds.back());
    };
  }
  UdpArmLink& add_arm(ArmEndSettings::Protocol protocol, std::optional<LinkKey> key = {}) {
    auto opened = UdpArmLink::open(
        io, clock, {.peer = server->local(), .end = {.protocol = protocol, .key = std::move(key)}},
        nullptr);
    EXPECT_TRUE(opened.has_value());
    arms.push_back(*std::move(opened));
    return *arms.back();
  }
  static bool is_up(UdpArmLink& arm) { return arm.status().is_up; }

  linux::MonotonicClock clock;
  boost::asio::io_context io{1};
  WorldDouble world_of_1999;
  std::vector<std::unique_ptr<WorldDouble>> worlds;
  std::unique_ptr<UdpWorldServer> server;
  std::vector<std::unique_ptr<UdpArmLink>> arms;
  std::uint64_t sequence{0};
};

TEST_F(UdpThimbleTest, BothProtocolsAreSpokenAtOnePort) {
  open_server({});
  UdpArmLink& ours = add_arm(ArmEndSettings::Protocol::Thimble);
  UdpArmLink& second = add_arm(ArmEndSettings::Protocol::Thimble);
  UdpArmLink& of_1999 = add_arm(ArmEndSettings::Protocol::Thesis);
  ASSERT_TRUE(run_until([&] { return is_up(ours) && is_up(second) && is_up(of_1999); }));
  EXPECT_EQ(worlds.size(), 2U);
  EXPECT_EQ(world_of_1999.opened, 1U);
  EXPECT_EQ(server->sessions().size(), 2U);
  coupling::ConstraintSet reply;
  ASSERT_TRUE(run_until([&] { return ours.arm_end().receive(reply); }));
  EXPECT_EQ(reply.planes.size(), 6U);
  for (auto& world : worlds) world->pressure = Force3{0, -1.25, 0};
  ASSERT_TRUE(run_until([&] { return ours.arm_end().receive(reply) && reply.has_pressure; }));
  EXPECT_EQ(reply.pressure, (Force3{0, -1.25, 0}));
  EXPECT_TRUE(ours.status().clocks.has_value());
  EXPECT_EQ(server->status().counters.rejected(), 0U);
}

TEST_F(UdpThimbleTest, WithAKeyNothingIsTakenWithout) {
  open_server({.end = {.key = key_of(1)}});
  UdpArmLink& good = add_arm(ArmEndSettings::Protocol::Thimble, key_of(1));
  UdpArmLink& wrong = add_arm(ArmEndSettings::Protocol::Thimble, key_of(2));
  UdpArmLink& none = add_arm(ArmEndSettings::Protocol::Thimble);
  UdpArmLink& of_1999 = add_arm(ArmEndSettings::Protocol::Thesis);
  ASSERT_TRUE(run_until([&] {
    const LinkCounters counters = server->status().counters;
    return is_up(good) && counters.rejected(RejectReason::BadSeal) >= 2 &&
           counters.rejected(RejectReason::WrongVersion) >= 1;
  }));
  for (UdpArmLink* arm : {&wrong, &none, &of_1999}) {
    EXPECT_FALSE(is_up(*arm));
    EXPECT_EQ(arm->status().counters.received, 0U);
  }
  EXPECT_EQ(world_of_1999.opened, 0U);
}

TEST_F(UdpThimbleTest, AKeyOpensTheWayBeyondLoopback) {
  UdpWorldServer::Settings settings;  // any interface
  const auto open_at = [&] {
    return UdpWorldServer::open(io, clock, settings, {.make_half = make_half()});
  };
  EXPECT_EQ(open_at().error().code, Errc::Permission);
  settings.end.key = key_of(1);
  EXPECT_TRUE(open_at().has_value());
  Endpoint far;
  far.address = {192, 0, 2, 1};  // RFC 5737: nobody's
  far.port = 5001;
  UdpArmLink::Settings arm{.peer = far, .end = {.protocol = ArmEndSettings::Protocol::Thimble}};
  EXPECT_EQ(UdpArmLink::open(io, clock, arm, nullptr).error().code, Errc::Permission);
  arm.end.key = key_of(1);
  EXPECT_TRUE(UdpArmLink::open(io, clock, arm, nullptr).has_value());
}

}  // namespace
}  // namespace thimble::link
