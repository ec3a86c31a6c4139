#include "cli/doctor/accounts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <grp.h>
#include <pwd.h>
#include <unistd.h>

#include <map>
#include <random>
#include <set>

#include "tests/support/temporary_folder.hpp"

namespace thimble::doctor {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::UnorderedElementsAreArray;

TEST(Accounts, AreFoundBehindALongListOfOthers) {
  testing_support::TemporaryFolder folder;
  std::string groups;
  std::string users;
  for (int i = 1; groups.size() < 300'000; ++i) {
    const std::string number = std::to_string(10'000 + i);
    groups += "group" + number + ":x:" + number + ":somebody,somebody-else\n";
    users += "user" + number + ":x:" + number + ":" + number + "::/home:/bin/sh\n";
  }
  folder.write("etc/group", groups + "thimble:x:42:an\n");
  folder.write("etc/passwd", users + "an:x:7:9::/:/bin/sh\n");
  const auto sut = accounts_below(folder.path());

  EXPECT_EQ(sut->group("thimble").value(), 42U);
  EXPECT_EQ(sut->user_name(7).value(), "an");
  EXPECT_THAT(sut->groups_of("an").value(), testing::UnorderedElementsAre(42, 9));
  EXPECT_EQ(sut->group("thimbles").value(), std::nullopt);
  EXPECT_EQ(sut->user_name(8).value(), "");
  EXPECT_TRUE(sut->groups_of("nobody").value().empty());
}

TEST(Accounts, AreRefusedByNameAndNotCutWhereTheyAreTooMany) {
  testing_support::TemporaryFolder folder;
  const auto file = folder.write("etc/group", "thimble:x:42:an\n");
  std::filesystem::resize_file(file, kMaxAccountBytes);
  EXPECT_EQ(accounts_below(folder.path())->group("thimble").value(), 42U);
  std::filesystem::resize_file(file, kMaxAccountBytes + 1);
  const auto sut = accounts_below(folder.path());

  const auto refused = sut->group("thimble");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::TooLarge);
  EXPECT_THAT(refused.error().message, AllOf(HasSubstr("/etc/group"), HasSubstr("16 MiB")));
  EXPECT_FALSE(sut->groups_of("an"));
  EXPECT_EQ(sut->user_name(7).value(), "") << "a file that is not there holds nobody";
}

TEST(Accounts, OfThisMachineAreThoseThatTheSystemNames) {
  const auto sut = accounts_below("/");
  const ::passwd* const user = ::getpwuid(0);
  ASSERT_NE(user, nullptr);
  const std::string name = user->pw_name;
  const gid_t primary = user->pw_gid;
  const ::group* const group = ::getgrgid(primary);
  ASSERT_NE(group, nullptr);

  EXPECT_EQ(sut->user_name(0).value(), name);
  EXPECT_EQ(sut->group(group->gr_name).value(), primary);
  EXPECT_THAT(sut->groups_of(name).value(), Contains(primary));
  EXPECT_EQ(sut->group("no-such-group-of-thimble").value(), std::nullopt);
  EXPECT_EQ(sut->user_name(4'000'000'000U).value(), "");
  EXPECT_TRUE(sut->groups_of("no-such-user-of-thimble").value().empty());
}

// Random files against a table of who is in what.
TEST(Accounts, AgreeWithWhoeverWroteTheFiles) {
  std::mt19937 random(240);
  for (int round = 0; round < 200; ++round) {
    std::map<std::string, std::set<std::uint32_t>> groups_of;
    std::string users;
    for (int i = 0; i < 6; ++i) {
      const std::string name = "u" + std::string(1 + random() % 3, static_cast<char>('a' + i));
      const auto primary = static_cast<std::uint32_t>(random() % 50);
      groups_of[name] = {primary};
      users += name + ":x:" + std::to_string(i) + ":" + std::to_string(primary) + "::/:\n";
      if (random() % 4 == 0) users += "odd\n";
    }
    std::string groups;
    for (std::uint32_t number = 50; number < 60; ++number) {
      groups += "g" + std::to_string(number) + ":x:" + std::to_string(number) + ":";
      for (auto& [name, numbers] : groups_of) {
        if (random() % 2 == 0) continue;
        numbers.insert(number);
        groups += (groups.back() == ':' ? "" : ",") + name;
      }
      groups += "\n";
    }
    testing_support::TemporaryFolder folder;
    folder.write("etc/passwd", users);
    folder.write("etc/group", groups);
    const auto sut = accounts_below(folder.path());
    for (const auto& [name, numbers] : groups_of) {
      EXPECT_THAT(sut->groups_of(name).value(), UnorderedElementsAreArray(numbers)) << groups;
    }
  }
}

}  // namespace
}  // namespace thimble::doctor
