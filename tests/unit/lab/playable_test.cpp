#include "lab/run/playable.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace thimble::lab {
namespace {

// Configurations of which all can be played, and what each change makes of them.
TEST(ReasonsNotToPlay, NameEachThingThatKeepsRealTime) {
  PlayedFile file{"one"};
  EXPECT_EQ(reasons_not_to_play({file}).size(), 1U) << "no arm";
  config::Config& config = file.config;
  config.arms.emplace_back();
  config.arms[0].name = "right";
  config.arms[0].device = "sim:phantom-vintage";
  config.arms[0].world = "box";
  config.worlds.emplace_back();
  config.worlds[0].name = "box";
  config.worlds[0].listen = config::UdpEndpoint{"127.0.0.1", 5001};
  config.safety = config::SafetyConfig{};
  EXPECT_TRUE(reasons_not_to_play({file}).empty());
  const auto expect_reason = [](const PlayedFile& changed, const std::string& key) {
    const auto reasons = reasons_not_to_play({changed});
    ASSERT_EQ(reasons.size(), 1U) << key;
    EXPECT_NE(reasons[0].find(key + ": "), std::string::npos) << reasons[0];
  };
  PlayedFile changed = file;
  changed.config.arms[0].device = "hid:1234";
  expect_reason(changed, "device");
  changed = file;
  changed.config.worlds[0].pieces = config::PiecesConfig{.board = config::PieceBoardKind::Pci};
  expect_reason(changed, "pieces.board");
  changed.config.worlds[0].pieces->board = config::PieceBoardKind::SimUsb;
  EXPECT_TRUE(reasons_not_to_play({changed}).empty());
}

TEST(ReasonsNotToPlay, AnArmThatLinksNeedsTheFileOfWhoListens) {
  PlayedFile host{"host"};
  host.config.worlds.emplace_back();
  host.config.worlds[0].listen = config::UdpEndpoint{"0.0.0.0", 5001};
  PlayedFile guest{"guest"};
  guest.config.arms.emplace_back();
  guest.config.arms[0].name = "right";
  guest.config.arms[0].device = "sim:phantom-vintage";
  guest.config.arms[0].link = config::UdpEndpoint{"10.0.0.1", 5001};
  EXPECT_TRUE(reasons_not_to_play({host, guest}).empty());
  const auto alone = reasons_not_to_play({guest});
  ASSERT_EQ(alone.size(), 1U);
  EXPECT_NE(alone[0].find("link: nobody listens at udp://10.0.0.1:5001"), std::string::npos);
  guest.config.servo.rate_hz = 4000;
  EXPECT_TRUE(reasons_not_to_play({host, guest}).empty()) << "the host says none";
  EXPECT_EQ(servo_rate_hz({host, guest}), 4000);
  host.config.servo.rate_hz = 1000;
  const auto faster = reasons_not_to_play({host, guest});
  ASSERT_EQ(faster.size(), 1U);
  EXPECT_TRUE(faster[0].starts_with("guest: servo.rate_hz: ")) << faster[0];
}

// A host with a world at a serial port, and one with an arm.
struct LineFiles : ::testing::Test {
  static PlayedFile host_at(const std::string& name, const std::string& node) {
    PlayedFile host{name};
    host.config.worlds.emplace_back();
    host.config.worlds[0].line = config::SerialEndpoint{node, 115'200};
    return host;
  }
  static PlayedFile guest_at(const std::string& name, const std::string& node) {
    PlayedFile guest{name};
    guest.config.arms.emplace_back();
    guest.config.arms[0].name = "right";
    guest.config.arms[0].device = "sim:phantom-vintage";
    guest.config.arms[0].line = config::SerialEndpoint{node, 57'600};
    return guest;
  }
};

TEST_F(LineFiles, OfTheSameDeviceArePlayedWhateverTheirRates) {
  const PlayedFile host = host_at("host", "/dev/ttyS0");
  EXPECT_TRUE(reasons_not_to_play({host, guest_at("guest", "/dev/ttyS0")}).empty());
  // Who listens may be left alone.
  EXPECT_TRUE(
      reasons_not_to_play({host, host_at("other", "/dev/ttyS1"), guest_at("guest", "/dev/ttyS0")})
          .empty());
}

TEST_F(LineFiles, WithNobodyAtTheOtherEndAreNotPlayed) {
  const auto guest = guest_at("guest", "/dev/ttyUSB0");
  const std::string nobody =
      "arm 'right': link: nobody listens at serial:/dev/ttyUSB0@57600; give the configuration of "
      "that host, too, with the same device there";
  EXPECT_EQ(reasons_not_to_play({guest}), std::vector{nobody});
  EXPECT_EQ(reasons_not_to_play({host_at("host", "/dev/ttyS0"), guest}),
            std::vector{"guest: " + nobody});
  // Two that speak, and none that listens.
  EXPECT_EQ(reasons_not_to_play({guest, guest_at("other", "/dev/ttyUSB0")}).size(), 2U);
  // A port has one end of a line, not both.
  PlayedFile both = guest;
  both.config.worlds = host_at("", "/dev/ttyUSB0").config.worlds;
  EXPECT_EQ(reasons_not_to_play({both}), std::vector{nobody});
}

TEST_F(LineFiles, OfThreeEndsAreNotPlayed) {
  const auto reasons =
      reasons_not_to_play({host_at("host", "/dev/ttyS0"), guest_at("left", "/dev/ttyS0"),
                           guest_at("right", "/dev/ttyS0")});
  ASSERT_EQ(reasons.size(), 2U);
  EXPECT_EQ(reasons[0],
            "left: arm 'right': link: 3 ends are at /dev/ttyS0, and a line has two; give each line "
            "a device of its own with --set");
}

TEST(HostAddresses, AreThoseByWhichTheOthersKnowThem) {
  PlayedFile host{"host"};
  host.config.worlds.emplace_back();
  host.config.worlds[0].listen = config::UdpEndpoint{"0.0.0.0", 5001};
  PlayedFile guest{"guest"};
  guest.config.arms.emplace_back();
  guest.config.arms[0].link = config::UdpEndpoint{"10.0.0.1", 5001};
  const auto in_words = [&] {
    std::vector<std::string> words;
    for (const link::Endpoint& one : host_addresses({host, guest})) words.push_back(to_string(one));
    return words;
  };
  EXPECT_EQ(in_words(), (std::vector<std::string>{"udp://10.0.0.1:0", "udp://127.0.0.1:0"}));
  host.config.worlds[0].peer = "10.0.0.2";
  EXPECT_EQ(in_words(), (std::vector<std::string>{"udp://10.0.0.1:0", "udp://10.0.0.2:0"}));
}

}  // namespace
}  // namespace thimble::lab
