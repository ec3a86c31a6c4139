#include "cli/file_text.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/support/small_disk.hpp"
#include "tests/support/temporary_folder.hpp"

namespace thimble::cli {
namespace {

TEST(RefuseEmptyName, RefusesNothingElse) {
  EXPECT_EQ(refuse_empty_name(""), "expected a name, found \"\"");
  for (const char* name : {"a", " ", "-", "/"}) EXPECT_EQ(refuse_empty_name(name), "") << name;
}

TEST(ReadAtMost, GivesAFileUpToTheLimitAndNoByteMore) {
  const testing_support::TemporaryFolder folder;
  std::string bytes(100'000, 'x');
  bytes[65'536] = '\0';
  const std::string file = folder.write("a", bytes);
  EXPECT_EQ(read_at_most(file, bytes.size() + 1), bytes);
  EXPECT_EQ(read_at_most(file, bytes.size()), bytes);
  EXPECT_EQ(read_at_most(file, 65'537), bytes.substr(0, 65'537));
  EXPECT_EQ(read_at_most(file, 0), "");
  EXPECT_EQ(read_at_most("/dev/zero", 70'000), std::string(70'000, '\0'));
}

TEST(ReadAtMost, SaysInTheSystemsWordWhatItCannotOpenOrRead) {
  const testing_support::TemporaryFolder folder;
  EXPECT_EQ(read_at_most((folder / "none").string(), 10).error(),
            (Error{Errc::NotFound, "cannot open it: No such file or directory"}));
  EXPECT_EQ(read_at_most(folder.path().string(), 10).error(),
            (Error{Errc::System, "cannot read it: Is a directory"}));
  const std::string file = folder.write("a", "x");
  EXPECT_EQ(read_at_most(file + "/b", 10).error(),
            (Error{Errc::System, "cannot open it: Not a directory"}));
}

TEST(ReadAtMost, TellsAFileThatMayNotBeReadFromOneThatIsNotThere) {
  const testing_support::TemporaryFolder folder;
  const std::string file = folder.write("a", "x");
  ASSERT_EQ(::chmod(folder.path().c_str(), 0755), 0);
  ASSERT_EQ(::chmod(file.c_str(), 0000), 0);
  constexpr uid_t kStranger = 65534;
  const bool is_root = ::geteuid() == 0;
  ASSERT_EQ(::seteuid(is_root ? kStranger : ::geteuid()), 0);
  const auto sut = read_at_most(file, 10);
  ASSERT_EQ(::seteuid(::getuid()), 0);
  ASSERT_FALSE(sut);
  EXPECT_EQ(sut.error(), (Error{Errc::System, "cannot open it: Permission denied"}));
}

TEST(ReadAtMost, TellsAWantOfDescriptorsFromAFileThatIsNotThere) {
  const testing_support::TemporaryFolder folder;
  const std::string file = folder.write("a", "x");
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit none{0, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
  const auto sut = read_at_most(file, 10);
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &before), 0);
  ASSERT_FALSE(sut);
  EXPECT_EQ(sut.error(), (Error{Errc::System, "cannot open it: Too many open files"}));
}

TEST(WriteWhole, SaysWhyItCannotAndLeavesWhatWasThere) {
  const testing_support::TemporaryFolder folder;
  const std::string file = folder.write("a", "good");
  ASSERT_TRUE(write_whole(file, "better"));
  {
    const testing_support::SmallDisk disk(1000);
    const Result<void> done = write_whole(file, std::string(2000, 'x'));
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().message, "cannot be written: File too large");
  }
  EXPECT_EQ(read_at_most(file, 10), "better");
}

}  // namespace
}  // namespace thimble::cli
