#include "hal/linux/replace_file.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include "tests/rt/in_child_process.hpp"
#include "tests/support/small_disk.hpp"
#include "tests/support/temporary_folder.hpp"

namespace thimble::linux {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLarge = 100'000;

struct ReplaceFile : testing::Test {
  testing_support::TemporaryFolder folder;
  std::string file = (folder / "file").string();

  static std::string text_of(const std::string& path) {
    std::ifstream stream(path);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  static mode_t mode_of(const std::string& path) {
    struct stat found {};
    return ::stat(path.c_str(), &found) == 0 ? found.st_mode & 07777U : 0;
  }
  [[nodiscard]] std::set<std::string> names() const {
    std::set<std::string> all;
    for (const auto& entry : fs::directory_iterator(folder.path())) {
      all.insert(entry.path().filename());
    }
    return all;
  }
};

TEST_F(ReplaceFile, MakesOneWithTheRightsThatAnyNewFileHas) {
  ASSERT_TRUE(replace_file(file, "new"));
  std::ofstream(folder / "other") << "x";
  EXPECT_EQ(text_of(file), "new");
  EXPECT_EQ(mode_of(file), mode_of((folder / "other").string()));
  EXPECT_EQ(names(), (std::set<std::string>{"file", "other"}));
}

TEST_F(ReplaceFile, LeavesNothingOfALongerOneAndKeepsItsRights) {
  folder.write("file", std::string(kLarge, 'o'));
  ASSERT_EQ(::chmod(file.c_str(), 0640), 0);
  ASSERT_TRUE(replace_file(file, "new"));
  EXPECT_EQ(text_of(file), "new");
  EXPECT_EQ(mode_of(file), 0640U);
}

TEST_F(ReplaceFile, ADiskThatBecomesFullTakesNothingAway) {
  folder.write("file", "good");
  const testing_support::SmallDisk disk(1000);
  for (const std::string& path : {file, (folder / "none").string()}) {
    const Result<void> done = replace_file(path, std::string(kLarge, 'n'));
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().code, Errc::System);
    EXPECT_EQ(done.error().message, std::strerror(EFBIG));
  }
  EXPECT_EQ(text_of(file), "good");
  EXPECT_EQ(names(), std::set<std::string>{"file"});
}

TEST_F(ReplaceFile, ALinkStaysOneAndWhatItLeadsToIsReplaced) {
  fs::create_directory(folder / "far");
  folder.write("far/file", "old");
  fs::create_symlink("far/file", file);
  fs::create_symlink("far/new", folder / "dangling");
  ASSERT_TRUE(replace_file(file, "new"));
  ASSERT_TRUE(replace_file((folder / "dangling").string(), "made"));
  EXPECT_TRUE(fs::is_symlink(file));
  EXPECT_EQ(text_of((folder / "far/file").string()), "new");
  EXPECT_EQ(text_of((folder / "far/new").string()), "made");
}

TEST_F(ReplaceFile, AFileOfMoreNamesHasTheNewTextUnderEach) {
  folder.write("file", std::string(kLarge, 'o'));
  fs::create_hard_link(file, folder / "other");
  ASSERT_TRUE(replace_file(file, "new"));
  EXPECT_EQ(text_of((folder / "other").string()), "new");
}

TEST_F(ReplaceFile, ADeviceIsWrittenAndSaysItself) {
  EXPECT_TRUE(replace_file("/dev/null", "text"));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_EQ(replace_file("/dev/full", "text").error().message, std::strerror(ENOSPC));
  EXPECT_EQ(replace_file(folder.path().string(), "text").error().message, std::strerror(EISDIR));
  EXPECT_EQ(replace_file(file + "/below", "text").error().message, std::strerror(ENOENT));
}

TEST_F(ReplaceFile, WhatADeadOneLeftIsNobodysPart) {
  const std::string left = ".thimble-" + std::to_string(::getpid()) + "-0.part";
  folder.write(left, "of the dead");
  ASSERT_TRUE(replace_file(file, "new"));
  EXPECT_EQ(text_of(file), "new");
  EXPECT_EQ(text_of((folder / left).string()), "of the dead");
}

// As where a disk has no room for one file more: written in its place, the earlier one would go.
TEST_F(ReplaceFile, WhereNoPartCanBeHadForAnotherReasonThanRightsTheFileStays) {
  folder.write("file", "good");
  for (int number = 0; number < 100; ++number) {
    folder.write(".thimble-" + std::to_string(::getpid()) + "-" + std::to_string(number) + ".part",
                 "of the dead");
  }
  EXPECT_EQ(replace_file(file, "new").error().message, std::strerror(EEXIST));
  EXPECT_EQ(text_of(file), "good");
}

TEST_F(ReplaceFile, RightsOfTheFileAndOfItsFolderCountAsForAnyWriter) {
  fs::create_directory(folder / "open");
  for (const char* name : {"open/theirs", "open/mine", "mine"}) folder.write(name, "old");
  ASSERT_EQ(::chmod(folder.path().c_str(), 0755), 0);
  ASSERT_EQ(::chmod((folder / "open").c_str(), 0777), 0);
  ASSERT_EQ(::chmod((folder / "open/theirs").c_str(), 0444), 0);
  if (::geteuid() == 0) {
    for (const char* name : {"open/mine", "mine"}) {
      ASSERT_EQ(::chown((folder / name).c_str(), 65534, 65534), 0);
    }
  }
  const std::string said = test::in_child_process(test::Rights::None, [this] {
    std::string all;
    for (const char* name : {"open/theirs", "open/mine", "mine", "new"}) {
      const Result<void> done = replace_file((folder / name).string(), "new");
      all += (done ? "done" : done.error().message) + "; ";
    }
    return all;
  });
  if (::geteuid() == 0) {
    EXPECT_EQ(said, "Permission denied; done; done; Permission denied; ");
    EXPECT_EQ(text_of((folder / "mine").string()), "new") << "in its place";
  }
  EXPECT_EQ(text_of((folder / "open/theirs").string()), "old");
  EXPECT_EQ(text_of((folder / "open/mine").string()), "new");
}

}  // namespace
}  // namespace thimble::linux
