// Several arms in one world, and arms that are coupled to each other.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "config_testing.hpp"

namespace thimble::config {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string one_arm(const std::string& name, const std::string& lines) {
  return "[[arm]]\nname = \"" + name + "\"\ndevice = \"sim:phantom-vintage\"\n" + lines + "\n";
}

std::string pair_of(const std::string& first, const std::string& second) {
  return one_arm("a", "peer = \"b\"\ncoupling.scheme = \"" + first + "\"") +
         one_arm("b", "peer = \"a\"\ncoupling.scheme = \"" + second + "\"");
}

TEST(ConfigHands, AreAsManyAsThereAreGuardsAndNoMore) {
  std::string text(kHello);
  for (std::size_t i = 1; i < kMaxArms; ++i) {
    text += one_arm("arm-" + std::to_string(i), "world = \"box\"");
  }
  EXPECT_THAT(mistakes(text), IsEmpty());
  text += one_arm("one-more", "world = \"box\"");
  EXPECT_THAT(mistakes(text), ElementsAre(HasSubstr("arm: expected at most 32 [[arm]], found 33")));
}

TEST(ConfigPeers, AreCoupledBySchemesThatFit) {
  for (const auto& [first, second] :
       {std::pair{"wave", "wave"}, std::pair{"spring-damper", "spring-damper"},
        std::pair{"ghost-point", "spring-damper"}, std::pair{"spring-damper", "ghost-point"}}) {
    const auto sut = parse_text(pair_of(first, second));
    ASSERT_TRUE(sut) << first << ' ' << second;
    EXPECT_EQ(sut->arms.at(0).peer, "b");
    EXPECT_FALSE(sut->arms.at(0).world);
  }
  for (const auto& [first, second] :
       {std::pair{"ghost-point", "ghost-point"}, std::pair{"wave", "spring-damper"},
        std::pair{"remote-force", "remote-force"}, std::pair{"ghost-point", "wave"},
        std::pair{"buffer-zone", "spring-damper"}}) {
    EXPECT_THAT(mistakes(pair_of(first, second)),
                testing::Contains(HasSubstr("two arms are coupled, streamed, by")))
        << first << ' ' << second;
  }
}

TEST(ConfigPeers, NameEachOtherAndNothingElse) {
  EXPECT_THAT(mistakes(one_arm("a", "peer = \"b\"")),
              ElementsAre(AllOf(HasSubstr("arm.0.peer"), HasSubstr("whose peer is \"a\""))));
  EXPECT_THAT(mistakes(one_arm("a", "peer = \"a\"")), ElementsAre(HasSubstr("arm.0.peer")));
  EXPECT_THAT(
      mistakes(one_arm("a", "peer = \"b\"") + one_arm("b", "link = \"udp://127.0.0.1:5001\"")),
      ElementsAre(HasSubstr("arm.0.peer")));
  EXPECT_THAT(mistakes(pair_of("wave", "wave") + one_arm("c", "peer = \"a\"\nworld = \"w\"") +
                       "[[world]]\nname = \"w\"\nsource = \"block\"\n"),
              testing::Contains(AllOf(HasSubstr("arm.2.peer"),
                                      HasSubstr("nor link beside it, found \"world\""))));
}

TEST(ConfigPeers, OneOfThemMayListenForAnArmOfAnotherHost) {
  const auto sut = parse_text(
      one_arm("a",
              "listen = \"udp://10.0.0.1:5001\"\nkey_file = \"/etc/link.key\"\n"
              "coupling.scheme = \"wave\"") +
      one_arm("b", "listen = \"serial:/dev/ttyS0@3000000\"\ncoupling.scheme = \"spring-damper\"") +
      one_arm("c",
              "listen = \"udp://10.0.0.1:0\"\nallow_unauthenticated = true\n"
              "peer = \"10.0.0.2\""));
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->arms.at(0).listen, (UdpEndpoint{"10.0.0.1", 5001}));
  EXPECT_EQ(sut->arms.at(0).key_file, "/etc/link.key");
  EXPECT_EQ(sut->arms.at(1).listen_line, (SerialEndpoint{"/dev/ttyS0", 3'000'000}));
  EXPECT_EQ(sut->arms.at(2).peer_address, "10.0.0.2");
  for (const ArmConfig& arm : sut->arms) {
    EXPECT_TRUE(arm.is_listening() && !arm.is_remote() && !arm.peer && !arm.world);
  }
}

TEST(ConfigPeers, AListeningArmIsRefusedWhatItCannotDo) {
  const std::string listen = "listen = \"udp://127.0.0.1:5001\"\n";
  const auto mistake = [](const std::string& lines) { return mistakes(one_arm("a", lines)); };
  EXPECT_THAT(mistake("listen = \"udp://10.0.0.1:5001\""),
              ElementsAre(AllOf(HasSubstr("arm.0.listen"), HasSubstr("or a key_file"))));
  for (const char* scheme : {"remote-force", "composite", "buffer-zone", "thesis-literal"}) {
    EXPECT_THAT(mistake(listen + "coupling.scheme = \"" + scheme + "\""),
                ElementsAre(AllOf(HasSubstr("arm.0.coupling"), HasSubstr(scheme))));
  }
  EXPECT_THAT(mistake(listen + "coupling.mode = \"lock-step\""),
              ElementsAre(AllOf(HasSubstr("arm.0.coupling"), HasSubstr("found \"lock-step\""))));
  EXPECT_THAT(mistake(listen + "coupling.scheme = \"spring-damper\"\n"
                               "coupling.passivity = \"two-port\""),
              ElementsAre(AllOf(HasSubstr("arm.0.coupling"), HasSubstr("not an arm"))));
  EXPECT_THAT(mistake(listen + "peer = \"b\""), ElementsAre(HasSubstr("a numeric address")));
  EXPECT_THAT(mistake(listen + "world = \"w\"\n"),
              testing::Contains(AllOf(HasSubstr("arm.0.listen"), HasSubstr("found \"world\""))));
  EXPECT_THAT(mistake(listen + "protocol = \"thimble\""),
              ElementsAre(AllOf(HasSubstr("arm.0.protocol"), HasSubstr("only beside link"))));
  EXPECT_THAT(mistakes(one_arm("a", "peer = \"b\"\nkey_file = \"k\"") +
                       one_arm("b", "peer = \"a\"\ncoupling.scheme = \"spring-damper\"")),
              ElementsAre(AllOf(HasSubstr("arm.0.key_file"), HasSubstr("link or listen"))));
  EXPECT_THAT(
      mistakes(one_arm("a", listen) + "[[world]]\nname = \"w\"\nsource = \"block\"\n" + listen),
      ElementsAre(AllOf(HasSubstr("world.0.listen"), HasSubstr("of its own"))));
}

TEST(ConfigPlace, IsWhereAnArmStands) {
  const std::string world = "[[world]]\nname = \"w\"\nsource = \"box:3\"\n";
  const auto sut = parse_text(one_arm("a", "world = \"w\"\nplace_m = [-0.03, 0, 0.5]") + world);
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->arms.at(0).place_m, (std::array{-0.03, 0.0, 0.5}));
  EXPECT_THAT(mistakes(one_arm("a", "world = \"w\"\nplace_m = [0, 0, 2]") + world),
              ElementsAre(HasSubstr("arm.0.place_m")));
  EXPECT_THAT(mistakes(one_arm("a",
                               "world = \"w\"\nplace_m = [0, 0, 0.1]\ncoupling.scheme = "
                               "\"buffer-zone\"") +
                       world),
              ElementsAre(AllOf(HasSubstr("arm.0.place_m"), HasSubstr("\"buffer-zone\""))));
}

TEST(ConfigBlock, IsASmallOneInARoom) {
  const std::string block = "[[world]]\nname = \"w\"\nsource = \"block\"\n";
  EXPECT_EQ(parse_text(block)->worlds.at(0).block, BlockConfig{});
  const auto sut =
      parse_text(block + "[world.block]\nedge_m = 0.02\nroom_m = 0.1\ndrag_newton_s_per_m = 5\n");
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->worlds.at(0).block, (BlockConfig{0.1, 0.02, 5}));
  const auto heavy =
      parse_text(block + "[world.block]\nfriction = 0.5\nweight_newton = [0, -1, 0]\n");
  ASSERT_TRUE(heavy);
  EXPECT_EQ(heavy->worlds.at(0).block, (BlockConfig{.friction = 0.5, .weight_newton = {0, -1, 0}}));
  EXPECT_THAT(mistakes(block + "block.friction = 1.5\n"), ElementsAre(HasSubstr("0 to 1")));
  EXPECT_THAT(mistakes(block + "block.weight_newton = [0, -21, 0]\n"),
              ElementsAre(HasSubstr("world.0.block.weight_newton")));
  EXPECT_THAT(mistakes(block + "block.edge_m = 0.09\n"),
              ElementsAre(AllOf(HasSubstr("world.0.block.edge_m"), HasSubstr("smaller than"))));
  EXPECT_THAT(mistakes(block + "block.drag_newton_s_per_m = 0\n"),
              ElementsAre(HasSubstr("1 to 10000")));
  EXPECT_THAT(mistakes(block + "workspace_m = 0.1\n"), ElementsAre(HasSubstr("\"block\"")));
  EXPECT_THAT(mistakes("[[world]]\nname = \"w\"\nsource = \"box:3\"\n[world.block]\n"),
              ElementsAre(AllOf(HasSubstr("world.0.block"), HasSubstr("\"box:3\""))));
  EXPECT_THAT(mistakes(block), IsEmpty());
}

}  // namespace
}  // namespace thimble::config
