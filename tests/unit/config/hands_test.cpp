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
