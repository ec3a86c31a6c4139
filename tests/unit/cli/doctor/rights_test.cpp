#include "cli/doctor/rights.hpp"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <grp.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <sys/xattr.h>
#include <unistd.h>

#include <array>
#include <random>

#include "cli/doctor/file_tree.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/cli/doctor/access_list_bytes.hpp"

namespace thimble::doctor {
namespace {

constexpr std::uint32_t kUser = 7;
constexpr std::uint32_t kGroup = 70;
constexpr std::uint32_t kBoth = kRead | kWrite;

Process member(std::vector<std::uint32_t> groups) {
  Process process;
  process.user = kUser;
  process.groups = std::move(groups);
  return process;
}

Node node(std::uint32_t mode, AccessList list = {}) {
  Node node;
  node.mode = mode;
  node.group = kGroup;
  node.access_list = std::move(list);
  return node;
}

TEST(Rights, GoByTheFirstClassThatFits) {
  EXPECT_TRUE(may(member({kGroup}), node(0660), kBoth));
  EXPECT_FALSE(may(member({kGroup}), node(0606), kBoth)) << "a member is nobody else";
  EXPECT_TRUE(may(member({71}), node(0606), kBoth));
  EXPECT_FALSE(may(member({kGroup}), node(0640), kBoth));
  EXPECT_TRUE(may(member({kGroup}), node(0640), kRead));
}

TEST(Rights, GoByTheEntryThatNamesAUserOrAnyOfTheirGroups) {
  EXPECT_TRUE(may(member({71}), node(0600, {{{kUser, 06}}, {}, 0}), kBoth));
  EXPECT_FALSE(may(member({kGroup}), node(0660, {{{kUser, 0}}, {}, 06}), kBoth));
  EXPECT_TRUE(may(member({kGroup, 71}), node(0600, {{}, {{71, 06}}, 0}), kBoth));
  EXPECT_FALSE(may(member({71, 72}), node(0606, {{}, {{71, 04}, {72, 02}}, 0}), kBoth))
      << "one entry has to grant it all";
}

// Whether the kernel lets such a process open the file.
bool opens(const std::filesystem::path& file, const Process& process) {
  const pid_t child = ::fork();
  if (child == 0) {
    std::array<gid_t, 8> groups{};
    std::copy(process.groups.begin(), process.groups.end(), groups.begin());
    const bool is_become = ::setgroups(process.groups.size(), groups.data()) == 0 &&
                           ::setresgid(999, 999, 999) == 0 &&
                           ::setresuid(process.user, process.user, process.user) == 0;
    ::_exit(!is_become ? 2 : ::open(file.c_str(), O_RDWR | O_CLOEXEC) >= 0 ? 0 : 1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) < 2);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST(Rights, AreWhatTheKernelGrants) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can become somebody else to try it";
  testing_support::TemporaryFolder folder;
  ::chmod(folder.path().c_str(), 0755);
  const auto file = folder.write("node", "");
  ASSERT_EQ(::chown(file.c_str(), 8, kGroup), 0);
  std::mt19937 random(241);
  const auto rights = [&] { return static_cast<std::uint32_t>(random() % 4 * 2); };
  for (int round = 0; round < 150; ++round) {
    std::vector<PlantedEntry> list{{0x01, rights()}};
    if (random() % 2 == 0) list.push_back({0x02, rights(), kUser});
    list.push_back({0x04, rights()});
    for (const std::uint32_t group : {71U, 72U}) {
      if (random() % 2 == 0) list.push_back({0x08, rights(), group});
    }
    list.push_back({0x10, rights()});
    list.push_back({0x20, rights()});
    const auto bytes = access_list_bytes(list);
    if (::setxattr(file.c_str(), "system.posix_acl_access", bytes.data(), bytes.size(), 0) != 0) {
      GTEST_SKIP() << "the folder of temporary files holds no access control lists";
    }
    Process process = member({});
    if (random() % 8 == 0) process.user = 8;
    for (const std::uint32_t group : {kGroup, 71U, 72U}) {
      if (random() % 2 == 0) process.groups.push_back(group);
    }
    const Node read = FileTree(folder.path()).node("/node");
    EXPECT_EQ(may(process, read, kBoth), opens(file, process)) << "round " << round;
  }
}

}  // namespace
}  // namespace thimble::doctor
