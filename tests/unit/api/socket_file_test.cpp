#include "daemon/api/socket_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <stdexcept>

#include "tests/support/temporary_folder.hpp"

namespace thimble::api {
namespace {

using testing::HasSubstr;

class SocketFileTest : public testing::Test {
 protected:
  static unsigned mode_of(const std::string& path) {
    struct stat info {};
    return ::stat(path.c_str(), &info) == 0 ? info.st_mode & 07777U : 0U;
  }

  testing_support::TemporaryFolder folder_;
  std::string path_{(folder_ / "run/thimble.sock").string()};
};

TEST_F(SocketFileTest, MakesItsFolderAndSetsTheMode) {
  const auto sut = SocketFile::create({path_, 0600, ""});
  ASSERT_TRUE(sut) << sut.error().message;
  EXPECT_EQ(mode_of(path_), 0600U);
  EXPECT_EQ(mode_of((folder_ / "run").string()), ::geteuid() == 0 ? 0755U : 0700U);
}

TEST_F(SocketFileTest, RemovesTheNameAtTheEndOnly) {
  {
    auto first = SocketFile::create({path_, 0660, ""});
    ASSERT_TRUE(first);
    const SocketFile moved = std::move(*first);
    EXPECT_TRUE(std::filesystem::exists(path_));
  }
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(SocketFileTest, LeavesARunningDaemonAlone) {
  const auto first = SocketFile::create({path_, 0660, ""});
  ASSERT_TRUE(first);
  const auto sut = SocketFile::create({path_, 0660, ""});
  ASSERT_FALSE(sut);
  EXPECT_EQ(sut.error().code, Errc::Busy);
  EXPECT_THAT(sut.error().message, HasSubstr("another daemon is running"));
  EXPECT_TRUE(std::filesystem::exists(path_));
}

TEST_F(SocketFileTest, LeavesAListenerWithoutALockAlone) {
  const auto first = SocketFile::create({path_, 0660, ""});
  ASSERT_TRUE(first);
  std::filesystem::remove(path_ + ".lock");
  const auto sut = SocketFile::create({path_, 0660, ""});
  ASSERT_FALSE(sut);
  EXPECT_EQ(sut.error().code, Errc::Busy);
}

TEST_F(SocketFileTest, ReplacesAStaleSocket) {
  {
    auto dead = SocketFile::create({path_, 0660, ""});
    ASSERT_TRUE(dead);
    // What a killed daemon leaves behind: the name, without a listener.
    std::filesystem::create_hard_link(path_, path_ + ".kept");
  }
  std::filesystem::rename(path_ + ".kept", path_);
  const auto sut = SocketFile::create({path_, 0660, ""});
  ASSERT_TRUE(sut);
  EXPECT_TRUE(sut->has_replaced_stale());
}

TEST_F(SocketFileTest, TellsAnOrderlyEndFromAnException) {
  for (int i = 0; i < 2; ++i) {
    const auto sut = SocketFile::create({path_, 0660, ""});
    ASSERT_TRUE(sut);
    EXPECT_FALSE(sut->has_replaced_stale());
  }
  try {
    const auto dead = SocketFile::create({path_, 0660, ""});
    ASSERT_TRUE(dead);
    throw std::runtime_error("out of memory, say");
  } catch (const std::runtime_error&) {
    EXPECT_TRUE(std::filesystem::exists(path_));
  }
  auto sut = SocketFile::create({path_, 0660, ""});
  ASSERT_TRUE(sut);
  const SocketFile moved = *std::move(sut);
  EXPECT_TRUE(moved.has_replaced_stale());
}

TEST_F(SocketFileTest, NeverRemovesAFileThatIsNoSocket) {
  std::filesystem::create_directory(folder_ / "run");
  std::ofstream(path_) << "precious";
  const auto sut = SocketFile::create({path_, 0660, ""});
  ASSERT_FALSE(sut);
  EXPECT_EQ(sut.error().code, Errc::InvalidArgument);
  EXPECT_EQ(std::filesystem::file_size(path_), 8U);
}

TEST_F(SocketFileTest, RefusesAPathThatNoSocketCanHave) {
  for (const std::string& path : {std::string(), "/tmp/" + std::string(200, 'x')}) {
    const auto sut = SocketFile::create({path, 0660, ""});
    ASSERT_FALSE(sut);
    EXPECT_EQ(sut.error().code, Errc::InvalidArgument);
  }
}

TEST_F(SocketFileTest, WithAnUnknownGroupLeavesNothingBehind) {
  const auto sut = SocketFile::create({path_, 0660, "no-such-group-here"});
  ASSERT_FALSE(sut);
  EXPECT_EQ(sut.error().code, Errc::NotFound);
  EXPECT_FALSE(std::filesystem::exists(path_));
}

}  // namespace
}  // namespace thimble::api
