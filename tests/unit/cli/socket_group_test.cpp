#include "cli/socket_group.hpp"

#include <gmock/gmock.h>
#include <grp.h>
#include <gtest/gtest.h>
#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cli/client.hpp"
#include "tests/support/temporary_folder.hpp"

namespace thimble::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr const char* kInstead = "set daemon.group = \"thimble-users\"";

// Somebody else's folder, of this group, with a socket in it that a stranger asks for.
Error refusal_of_group(gid_t number) {
  const testing_support::TemporaryFolder folder;
  EXPECT_EQ(::chown(folder.path().c_str(), 0, number), 0);
  EXPECT_EQ(::chmod(folder.path().c_str(), 0700), 0);
  constexpr uid_t kStranger = 65534;
  EXPECT_EQ(::seteuid(kStranger), 0);
  const auto sut = Client::connect((folder / "t.sock").string());
  EXPECT_EQ(::seteuid(0), 0);
  EXPECT_FALSE(sut);
  return sut ? Error{} : sut.error();
}

// The group is that of the folder where the socket itself may not be seen.
TEST(SocketGroup, IsNamedWhereItIsOneToBecomeAMemberOf) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can give a folder to another group";
  const group* const others = ::getgrnam("audio");
  ASSERT_NE(others, nullptr);
  const Error sut = refusal_of_group(others->gr_gid);
  EXPECT_EQ(sut.code, Errc::Permission);
  EXPECT_THAT(sut.message, HasSubstr("sudo adduser \"$USER\" audio, then log in anew"));
}

TEST(SocketGroup, IsNotToBeJoinedWhereItIsRootsOrOpensMoreThanTheSocket) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can give a folder to another group";
  for (const char* name : {"root", "adm", "disk", "shadow", "sudo", "www-data"}) {
    const group* const privileged = ::getgrnam(name);
    ASSERT_NE(privileged, nullptr) << name;
    const Error sut = refusal_of_group(privileged->gr_gid);
    EXPECT_EQ(sut.code, Errc::Permission) << name;
    EXPECT_THAT(sut.message, Not(HasSubstr("adduser"))) << name;
    EXPECT_THAT(sut.message, HasSubstr(kInstead)) << name;
  }
}

// As a program of root's makes it that is told of no group.
TEST(SocketGroup, OfRootItselfIsNeverAdvised) {
  const std::string sut = advice_to_join("/");
  EXPECT_THAT(sut, Not(HasSubstr("adduser")));
  EXPECT_THAT(sut, HasSubstr(kInstead));
  EXPECT_FALSE(is_for_people(0, ""));
  EXPECT_FALSE(is_for_people(0, "another-name-of-it"));
}

TEST(SocketGroup, IsForPeopleUnlessItIsPrivilegedOrAnAccountsOwn) {
  EXPECT_TRUE(is_for_people(998, "thimble-users"));
  EXPECT_TRUE(is_for_people(29, "audio"));
  for (const char* name : {"sudo", "wheel", "docker", "kmem", "staff", "thimble"}) {
    EXPECT_FALSE(is_for_people(998, name)) << name;
  }
  const passwd* const account = ::getpwnam("www-data");
  ASSERT_NE(account, nullptr);
  EXPECT_FALSE(is_for_people(account->pw_gid, "www-data"));
}

TEST(SocketGroup, ThatCannotBeSeenIsSpokenOfInGeneral) {
  EXPECT_THAT(advice_to_join("/none/at/all.sock"), HasSubstr("the group that owns this socket"));
}

}  // namespace
}  // namespace thimble::cli
