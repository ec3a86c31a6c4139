#include "daemon/config/socket_place.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <optional>
#include <string>

#include "tests/support/temporary_folder.hpp"

namespace thimble::config {
namespace {

namespace fs = std::filesystem;

// A folder as /tmp is, where somebody else may have been first.
class SocketPlace : public ::testing::Test {
 protected:
  static constexpr uid_t kStranger = 1001;

  void SetUp() override { chmod(folder_.path(), 01777); }
  static void chmod(const fs::path& path, mode_t mode) {
    ASSERT_EQ(::chmod(path.c_str(), mode), 0) << path;
  }
  static void give(const fs::path& path) {
    ASSERT_EQ(::lchown(path.c_str(), kStranger, kStranger), 0) << path;
  }
  static std::optional<Errc> trouble(const fs::path& path) {
    const auto done = check_socket_place(path);
    return done ? std::nullopt : std::optional(done.error().code);
  }

  testing_support::TemporaryFolder folder_;
};

TEST_F(SocketPlace, IsWellWhereItIsTheCallersOwn) {
  EXPECT_EQ(trouble(folder_.write("t.sock", "")), std::nullopt);
  EXPECT_EQ(trouble(folder_.write("mine/t.sock", "")), std::nullopt);
  EXPECT_EQ(trouble(folder_ / "mine/none.sock"), std::nullopt) << "nobody else can put it there";
  EXPECT_EQ(trouble("/run/thimble/thimble.sock"), std::nullopt);
}

TEST_F(SocketPlace, IsNotYetThereWhereAnybodyMayStillMakeIt) {
  EXPECT_EQ(trouble(folder_ / "none.sock"), Errc::NotFound);
  EXPECT_EQ(trouble(folder_ / "none/t.sock"), Errc::NotFound);
}

TEST_F(SocketPlace, IsNobodysWithoutTheStickyBit) {
  const fs::path socket = folder_.write("mine/t.sock", "");
  chmod(folder_.path(), 0777);
  EXPECT_EQ(trouble(socket), Errc::Permission);
  chmod(folder_.path(), 0775);
  EXPECT_EQ(trouble(socket), std::nullopt);
}

TEST_F(SocketPlace, IsAStrangersByTheSocketTheFolderALinkOrAnyFolderAbove) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can give a file to somebody else";
  give(folder_.write("t.sock", ""));
  EXPECT_EQ(trouble(folder_ / "t.sock"), Errc::Permission);

  folder_.write("theirs/deep/t.sock", "");
  EXPECT_EQ(trouble(folder_ / "theirs/deep/t.sock"), std::nullopt);
  give(folder_ / "theirs");
  EXPECT_EQ(trouble(folder_ / "theirs/deep/t.sock"), Errc::Permission);
  folder_.write("mine/t.sock", "");
  EXPECT_EQ(trouble(folder_ / "theirs/../mine/t.sock"), Errc::Permission) << "a link might be it";

  fs::create_symlink("mine", folder_ / "link");
  EXPECT_EQ(trouble(folder_ / "link/t.sock"), std::nullopt) << "root made it";
  give(folder_ / "link");
  EXPECT_EQ(trouble(folder_ / "link/t.sock"), Errc::Permission);

  chmod(folder_.path(), 0755);
  EXPECT_EQ(trouble(folder_ / "theirs/deep/t.sock"), std::nullopt) << "root let them have it";
}

}  // namespace
}  // namespace thimble::config
