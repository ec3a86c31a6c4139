#include "daemon/session/arm_host.hpp"

#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <functional>
#include <memory>
#include <string>

#include "daemon/link/udp_arm_link.hpp"
#include "daemon/link/udp_network.hpp"
#include "daemon/session/arm_settings.hpp"
#include "hal/linux/monotonic_clock.hpp"

// An arm that listens on loopback, and what another daemon's link to it is told. Nothing here
// judges a time: waits are bounded generously, and end when what they wait for has happened.
namespace thimble::session {
namespace {

config::ArmConfig arm_of(config::CouplingScheme scheme) {
  config::ArmConfig said;
  said.name = "left";
  said.device = "sim:phantom-vintage";
  said.coupling.scheme = scheme;
  return said;
}

class ArmHostTest : public ::testing::Test {
 protected:
  std::unique_ptr<ArmHost> open(config::CouplingScheme scheme) {
    config::ArmConfig said = arm_of(scheme);
    said.listen = config::UdpEndpoint{"127.0.0.1", 0};
    return ArmHost::create(said, parts).value();
  }
  std::unique_ptr<link::UdpArmLink> guest(const ArmHost& host, config::CouplingScheme scheme) {
    config::ArmConfig said = arm_of(scheme);
    said.protocol = config::LinkProtocol::Thimble;
    link::UdpArmLink::Settings settings;
    settings.peer = host.listener().local();
    settings.end = arm_end_settings(said).value();
    return link::UdpArmLink::open(io, clock, settings, nullptr).value();
  }
  // Both arms say where they are, again and again.
  bool run_until(link::UdpArmLink& guest, coupling::WorldCoupling& host,
                 const std::function<bool()>& is_done) {
    for (int i = 0; i < 20000 && !is_done(); ++i) {
      if (io.stopped()) io.restart();
      coupling::HandSample sample{.sequence = ++sequence, .sampled_at = clock.now()};
      sample.hand = {0.01, 0, 0};
      sample.tool = {{300}, {5}};
      told = host.answer(sample, std::chrono::milliseconds(1));
      sample.hand = {0.02, 0, 0};
      sample.pull = {2, 0, 0};
      guest.arm_end().send(sample);
      guest.on_wake();
      io.run_one_for(std::chrono::milliseconds(1));
      static_cast<void>(guest.arm_end().receive(heard));
    }
    return is_done();
  }

  linux::MonotonicClock clock;
  boost::asio::io_context io{1};
  link::UdpNetwork network{io};
  plugin::SimModelRegistry models;
  plugin::DriverRegistry drivers;
  RigParts parts{.models = models, .drivers = drivers, .real_clock = &clock, .network = &network};
  std::uint64_t sequence{0};
  coupling::ConstraintSet told{};   // to the arm of this host
  coupling::ConstraintSet heard{};  // by the guest
};

TEST_F(ArmHostTest, EachArmIsToldOfTheOther) {
  const auto sut = open(config::CouplingScheme::SpringDamper);
  const auto half = sut->make_half();
  ASSERT_TRUE(half->open({}));
  EXPECT_EQ(sut->guest(), "");
  const auto other = guest(*sut, config::CouplingScheme::SpringDamper);
  ASSERT_TRUE(run_until(*other, *half, [&] { return heard.has_far && told.has_far; }));
  EXPECT_EQ(heard.far.slave, (Position3{0.01, 0, 0}));
  EXPECT_TRUE(heard.far.is_arm);
  EXPECT_EQ(heard.far.tool, (coupling::ToolProperties{{300}, {5}}));
  EXPECT_EQ(told.far.slave, (Position3{0.02, 0, 0}));
  EXPECT_EQ(other->status().arm, "left");
  EXPECT_NE(sut->guest(), "");
}

// What stops a follower of another host is told as a wall: by its pull, which came with it.
TEST_F(ArmHostTest, AGhostPointOfThisHostFeelsWhatStopsAFollowerOfAnother) {
  const auto sut = open(config::CouplingScheme::Auto);
  const auto half = sut->make_half();
  ASSERT_TRUE(half->open({}));
  const auto other = guest(*sut, config::CouplingScheme::SpringDamper);
  ASSERT_TRUE(run_until(*other, *half, [&] { return !told.planes.empty(); }));
  EXPECT_EQ(told.planes[0].normal, (Direction3{1, 0, 0}));
  EXPECT_EQ(told.planes[0].surface.stiffness.newton_per_m, 300);
}

TEST_F(ArmHostTest, SaysOnBothSidesWhyTwoSchemesDoNotGoTogether) {
  const auto sut = open(config::CouplingScheme::Wave);
  const auto half = sut->make_half();
  const auto other = guest(*sut, config::CouplingScheme::SpringDamper);
  ASSERT_TRUE(run_until(*other, *half, [&] { return !other->status().last_error.empty(); }));
  EXPECT_EQ(other->status().last_error,
            "the far end is an arm of the scheme wave, which does not go with spring-damper");
  const std::string mine = sut->listener().status().last_error;
  EXPECT_NE(mine.find("its scheme spring-damper does not go with wave here"), std::string::npos)
      << mine;
  EXPECT_EQ(sut->guest(), "");
}

TEST_F(ArmHostTest, ListensOnlyWhereThereIsANetwork) {
  config::ArmConfig said = arm_of(config::CouplingScheme::Wave);
  said.listen = config::UdpEndpoint{"127.0.0.1", 0};
  const auto sut = ArmHost::create(said, {.models = models, .drivers = drivers});
  ASSERT_FALSE(sut);
  EXPECT_EQ(sut.error().message,
            "arm 'left': listen: there is no network for arms of other hosts to come by");
}

}  // namespace
}  // namespace thimble::session
