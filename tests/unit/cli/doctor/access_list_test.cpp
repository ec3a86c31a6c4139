#include "cli/doctor/access_list.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/unit/cli/doctor/access_list_bytes.hpp"

namespace thimble::doctor {
namespace {

std::optional<AccessList> parsed(const std::vector<PlantedEntry>& entries) {
  return parse_access_list(access_list_bytes(entries));
}

TEST(AccessListBytes, NameTheUserOfTheSeat) {
  EXPECT_EQ(parsed(kListOfASeat), (AccessList{{{1000, 06}}, {}, 06}));
}

TEST(AccessListBytes, NameNobodyWhereOnlyThePermissionBitsAreSaidAgain) {
  EXPECT_EQ(parsed({{0x01, 06}, {0x04, 06}, {0x20, 0}}), (AccessList{{}, {}, 06}));
  EXPECT_EQ(parsed({}), AccessList{});
}

TEST(AccessListBytes, LeaveWhatTheMaskLeaves) {
  EXPECT_EQ(parsed({{0x02, 06, 7}, {0x02, 04, 8}, {0x04, 07}, {0x08, 02, 9}, {0x10, 02}}),
            (AccessList{{{7, 02}, {8, 0}}, {{9, 02}}, 02}));
  EXPECT_EQ(parsed({{0x04, 04}, {0x02, 06, 7}, {0x10, 0}}), (AccessList{{}, {}, 0}))
      << "under an empty mask the kernel looks at no list";
  EXPECT_EQ(parsed({{0x04, 0}, {0x10, 07}}), (AccessList{{}, {}, 0}))
      << "the group's right is its own and not the mask";
}

TEST(AccessListBytes, AreNoListWhenOneOfThemIsOdd) {
  EXPECT_FALSE(parsed({{0x03, 06}})) << "two tags";
  EXPECT_FALSE(parsed({{0, 06}}));
  EXPECT_FALSE(parsed({{0x40, 06}}));
  EXPECT_FALSE(parsed({{0x02, 010, 7}})) << "an unknown right";
  EXPECT_FALSE(parse_access_list(access_list_bytes(kListOfASeat, 1)));
  EXPECT_FALSE(parse_access_list({}));
}

TEST(AccessListBytes, AreNoListWhenTheyAreCutShort) {
  const std::vector<std::byte> whole = access_list_bytes(kListOfASeat);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const auto part = parse_access_list(std::span(whole).first(size));
    EXPECT_EQ(part.has_value(), size >= 4 && size % 8 == 4) << size;
  }
}

TEST(AccessListBytes, AreTakenWhateverTheyAre) {
  std::mt19937 random(5);
  for (int i = 0; i < 20000; ++i) {
    std::vector<std::byte> bytes = access_list_bytes(kListOfASeat);
    bytes.at(random() % bytes.size()) = static_cast<std::byte>(random());
    const auto list = parse_access_list(bytes);
    if (!list) continue;
    EXPECT_LE(list->users.size() + list->groups.size(), kListOfASeat.size());
  }
}

}  // namespace
}  // namespace thimble::doctor
