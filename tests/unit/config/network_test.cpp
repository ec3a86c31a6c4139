#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <utility>

#include "tests/unit/config/config_testing.hpp"

namespace thimble::config {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

// The datagrams of 1999 know no key at either end: who can forge the world's address moves the arm.
TEST(ConfigNetwork, AnArmLinksBeyondThisMachineOnlyWhenItIsSaid) {
  const auto with_link = [](const std::string& lines) {
    return "[[arm]]\nname = \"right\"\ndevice = \"sim:phantom-vintage\"\n" + lines;
  };
  for (const char* address : {"10.0.0.7", "[2001:db8::7]", "0.0.0.0"}) {
    const std::string link = "link = \"udp://" + std::string(address) + ":5001\"\n";
    EXPECT_THAT(mistakes(with_link(link)),
                ElementsAre(AllOf(HasSubstr("t.toml:4:8: arm.0.link: expected a loopback address"),
                                  HasSubstr("allow_unauthenticated = true"), HasSubstr(address))));
    EXPECT_THAT(mistakes(with_link(link + "allow_unauthenticated = false\n")), SizeIs(1));
    const auto sut = parse_text(with_link(link + "allow_unauthenticated = true\n"));
    ASSERT_TRUE(sut) << address;
    EXPECT_TRUE(sut->arms[0].allow_unauthenticated);
  }
  EXPECT_TRUE(parse_text(with_link("link = \"udp://127.0.0.2:5001\"\n")));
}

// With a key our own datagrams go anywhere; those of 1999 know none.
TEST(ConfigNetwork, AKeyOpensTheWayBeyondThisMachineToOurOwnDatagrams) {
  const std::string arm =
      "[[arm]]\nname = \"right\"\ndevice = \"sim:phantom-vintage\"\n"
      "link = \"udp://10.0.0.7:5001\"\n";
  const auto sut = parse_text(arm + "protocol = \"thimble\"\nkey_file = \"link.key\"\n");
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->arms[0].protocol, LinkProtocol::Thimble);
  EXPECT_EQ(sut->arms[0].key_file, "/etc/thimble/link.key");
  EXPECT_THAT(mistakes(arm + "protocol = \"thimble\"\n"),
              ElementsAre(AllOf(HasSubstr("arm.0.link"), HasSubstr("key_file"))));
  EXPECT_THAT(mistakes(arm + "key_file = \"link.key\"\n"),
              ElementsAre(AllOf(HasSubstr("arm.0.key_file"), HasSubstr("of 1999 know no key"))));
  const std::string world = "[[world]]\nname = \"box\"\nsource = \"box:3\"\n";
  const std::string listen = "listen = \"udp://0.0.0.0:5001\"\n";
  const auto open = parse_text(world + listen + "key_file = \"/etc/link.key\"\n");
  ASSERT_TRUE(open);
  EXPECT_EQ(open->worlds[0].key_file, "/etc/link.key");
  EXPECT_THAT(mistakes(world + listen),
              ElementsAre(AllOf(HasSubstr("world.0.listen"), HasSubstr("a key_file"))));
  EXPECT_THAT(mistakes(world + "key_file = \"link.key\"\n"),
              ElementsAre(AllOf(HasSubstr("world.0.key_file"), HasSubstr("only beside listen"))));
}

TEST(ConfigNetwork, ADeadbandIsForStreamsOfOurOwnAndAForceOfTheArm) {
  const std::string arm =
      "[[arm]]\nname = \"right\"\ndevice = \"sim:phantom-vintage\"\n"
      "link = \"udp://127.0.0.1:5001\"\ndeadband_m = 0.0005\n";
  const std::string ours = arm + "protocol = \"thimble\"\n";
  const auto sut = parse_text(ours);
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->arms[0].deadband_m, 0.0005);
  for (const std::string& bad :
       {arm, ours + "coupling.mode = \"lock-step\"\n", ours + "coupling.scheme = \"wave\"\n"}) {
    EXPECT_THAT(mistakes(bad), ElementsAre(HasSubstr("arm.0.deadband_m"))) << bad;
  }
}

TEST(ConfigNetwork, ALinkAndAListenerMayBeASerialLine) {
  const std::string arm = "[[arm]]\nname = \"right\"\ndevice = \"sim:phantom-vintage\"\n";
  const auto sut = parse_text(arm +
                              "link = \"serial:/dev/serial/by-id/usb-a@b@3000000\"\n"
                              "[[world]]\nname = \"box\"\nsource = \"box:3\"\n"
                              "listen = \"serial:/dev/ttyS0@38400\"\n");
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->arms[0].line, (SerialEndpoint{"/dev/serial/by-id/usb-a@b", 3'000'000}));
  EXPECT_EQ(sut->worlds[0].line, (SerialEndpoint{"/dev/ttyS0", 38'400}));
  EXPECT_TRUE(sut->arms[0].is_remote() && sut->worlds[0].is_listening());
  for (const char* bad : {"serial:ttyS0@38400", "serial:/dev/ttyS0", "serial:/dev/ttyS0@19200",
                          "serial:/dev/ttyS0@115201", "serial:/dev/ttyS0@", "serial:@38400"}) {
    EXPECT_THAT(mistakes(arm + "link = \"" + bad + "\"\n"),
                testing::Contains(AllOf(HasSubstr("arm.0.link"), HasSubstr("38400 to 3000000"))))
        << bad;
  }
}

TEST(ConfigNetwork, ALineHasTwoEndsAndNoAddresses) {
  const std::string arm =
      "[[arm]]\nname = \"right\"\ndevice = \"sim:phantom-vintage\"\n"
      "link = \"serial:/dev/ttyS0@38400\"\n";
  const std::string world =
      "[[world]]\nname = \"box\"\nsource = \"box:3\"\nlisten = \"serial:/dev/ttyS0@38400\"\n";
  EXPECT_THAT(mistakes(arm + world), ElementsAre(AllOf(HasSubstr("world.0.listen"),
                                                       HasSubstr("a serial port of its own"))));
  for (const char* line : {"allow_unauthenticated = true\n", "peer = \"10.0.0.2\"\n"}) {
    EXPECT_THAT(mistakes(world + line),
                ElementsAre(HasSubstr("expected only beside an address, found beside a line")));
  }
  EXPECT_THAT(mistakes(arm + "allow_unauthenticated = true\n"), SizeIs(1));
  EXPECT_THAT(mistakes(arm + "coupling.scheme = \"wave\"\n"), SizeIs(1));
}

// A socket of one family never hears a peer of the other, but [::] hears both.
TEST(ConfigNetwork, ThePeerIsOneThatTheListenerCanHear) {
  const auto with = [](const std::string& listen, const std::string& peer) {
    return "[[world]]\nname = \"box\"\nsource = \"box:3\"\nallow_unauthenticated = true\nlisten = "
           "\"udp://" +
           listen + ":5001\"\npeer = \"" + peer + "\"\n";
  };
  const std::array<std::pair<const char*, const char*>, 6> kGood{{{"0.0.0.0", "10.0.0.2"},
                                                                  {"0.0.0.0", "::ffff:10.0.0.2"},
                                                                  {"[::]", "10.0.0.2"},
                                                                  {"[::]", "2001:db8::2"},
                                                                  {"[::ffff:10.0.0.1]", "10.0.0.2"},
                                                                  {"[::1]", "::1"}}};
  for (const auto& [listen, peer] : kGood) EXPECT_TRUE(parse_text(with(listen, peer))) << listen;
  const std::array<std::pair<const char*, const char*>, 4> kBad{{{"0.0.0.0", "2001:db8::2"},
                                                                 {"127.0.0.1", "::1"},
                                                                 {"[::1]", "127.0.0.1"},
                                                                 {"[2001:db8::1]", "10.0.0.2"}}};
  for (const auto& [listen, peer] : kBad) {
    EXPECT_THAT(mistakes(with(listen, peer)),
                ElementsAre(AllOf(HasSubstr("t.toml:6:8: world.0.peer: expected an address that "
                                            "can reach"),
                                  HasSubstr(listen), HasSubstr(peer))));
  }
}

}  // namespace
}  // namespace thimble::config
