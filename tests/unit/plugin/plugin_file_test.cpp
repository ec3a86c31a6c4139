#include "hal/plugin/plugin_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>

#include "tests/support/temporary_folder.hpp"

namespace thimble::plugin {
namespace {

using testing::HasSubstr;

constexpr uid_t kUser = 1000;

TEST(PluginFile, OnlyRootAndTheDaemonsUserMayOwnIt) {
  EXPECT_EQ(why_untrusted({S_IFREG | 0644, 0}, kUser), "");
  EXPECT_EQ(why_untrusted({S_IFREG | 0600, kUser}, kUser), "");
  EXPECT_THAT(why_untrusted({S_IFREG | 0644, kUser}, 0), HasSubstr("belongs to user 1000"));
  EXPECT_THAT(why_untrusted({S_IFDIR | S_ISVTX | 0755, 33}, kUser), HasSubstr("user 33"));
}

TEST(PluginFile, NobodyElseMayWriteToIt) {
  for (const mode_t mode : {0664U, 0646U, 0777U, 0620U}) {
    EXPECT_THAT(why_untrusted({S_IFREG | mode, 0}, kUser), HasSubstr("chmod go-w")) << mode;
    EXPECT_THAT(why_untrusted({S_IFDIR | mode, 0}, kUser), HasSubstr("chmod go-w")) << mode;
    EXPECT_EQ(why_untrusted({S_IFDIR | S_ISVTX | mode, 0}, kUser), "") << "as /tmp: " << mode;
    EXPECT_NE(why_untrusted({S_IFREG | S_ISVTX | mode, 0}, kUser), "")
        << "of a file it says nothing";
  }
}

TEST(PluginPathOfACommandLine, MeansTheWorkingFolderWhereItIsRelative) {
  const std::string here = std::filesystem::current_path().string();
  EXPECT_EQ(absolute_plugin_path("plugin.so").value(), here + "/plugin.so");
  EXPECT_EQ(absolute_plugin_path("/opt/plugin.so").value(), "/opt/plugin.so");
}

TEST(PluginPathOfACommandLine, IsRefusedWhereItIsEmpty) {
  const auto sut = absolute_plugin_path("");
  ASSERT_FALSE(sut);
  EXPECT_EQ(sut.error().code, Errc::InvalidArgument);
  EXPECT_EQ(sut.error().message, "--plugin: the name of a file is expected, and it is empty");
}

TEST(PluginPathOfACommandLine, IsRefusedWhereTheWorkingFolderIsGone) {
  const testing_support::TemporaryFolder folder;
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::create_directory(folder / "gone");
  std::filesystem::current_path(folder / "gone");
  std::filesystem::remove(folder / "gone");
  const auto relative = absolute_plugin_path("plugin.so");
  const auto absolute = absolute_plugin_path("/opt/plugin.so");
  std::filesystem::current_path(before);
  ASSERT_FALSE(relative);
  EXPECT_EQ(relative.error().code, Errc::System);
  EXPECT_THAT(relative.error().message,
              HasSubstr("where plugin.so would be, cannot be had: No such"));
  EXPECT_EQ(absolute.value(), "/opt/plugin.so");
}

class PluginPath : public testing::Test {
 protected:
  std::string refusal(const std::filesystem::path& path) {
    const auto found = trusted_plugin_path(path.string());
    return found ? "" : found.error().message;
  }
  testing_support::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.write("inner/plugin.so", "x");
  void SetUp() override {
    ASSERT_EQ(::chmod(file_.c_str(), 0644), 0);
    ASSERT_EQ(::chmod((folder_ / "inner").c_str(), 0755), 0);
  }
};

TEST_F(PluginPath, IsTheFilesWithEveryLinkFollowed) {
  const auto link = folder_ / "link.so";
  std::filesystem::create_symlink("inner/../inner/plugin.so", link);
  const auto found = trusted_plugin_path(link.string());
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(*found, std::filesystem::canonical(file_).string());
}

TEST_F(PluginPath, MustBeThatOfARegularFileFromTheRoot) {
  EXPECT_THAT(refusal("plugin.so"), HasSubstr("not an absolute path"));
  EXPECT_THAT(refusal(""), HasSubstr("not an absolute path"));
  EXPECT_THAT(refusal(folder_ / "none.so"), HasSubstr("no such file"));
  EXPECT_THAT(refusal(folder_ / "inner"), HasSubstr("not a regular file"));
  EXPECT_THAT(refusal("/dev/null"), HasSubstr("not a regular file"));
  EXPECT_THAT(refusal(file_ / "below"), HasSubstr("cannot be looked at: Not a directory"));
}

TEST_F(PluginPath, IsRefusedWhereOthersMayWriteToTheFileOrAFolderAboveIt) {
  ASSERT_EQ(::chmod(file_.c_str(), 0664), 0);
  EXPECT_THAT(refusal(file_),
              testing::AllOf(testing::StartsWith("may be written by"), HasSubstr("chmod go-w")))
      << "its name stands in front of it already";
  ASSERT_EQ(::chmod(file_.c_str(), 0644), 0);
  ASSERT_EQ(::chmod((folder_ / "inner").c_str(), 0777), 0);
  EXPECT_THAT(refusal(file_), HasSubstr("inner may be written by"));
  std::filesystem::create_symlink(file_, folder_ / "link.so");
  EXPECT_THAT(refusal(folder_ / "link.so"), HasSubstr("inner may be written by"))
      << "a link in a good folder to a file in a bad one";
  ASSERT_EQ(::chmod((folder_ / "inner").c_str(), 01777), 0);
  EXPECT_EQ(refusal(file_), "") << "sticky: nobody can replace what is not theirs";
}

TEST_F(PluginPath, IsRefusedWhereTheFileIsAnotherUsers) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can give a file away";
  ASSERT_EQ(::chown(file_.c_str(), 33, 33), 0);
  EXPECT_THAT(refusal(file_), HasSubstr("belongs to user 33"));
}

}  // namespace
}  // namespace thimble::plugin
