#include "cli/file_text.hpp"

#include <gtest/gtest.h>

#include "tests/support/small_disk.hpp"
#include "tests/support/temporary_folder.hpp"

namespace thimble::cli {
namespace {

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

TEST(ReadAtMost, SaysWhatItCannotOpenOrRead) {
  const testing_support::TemporaryFolder folder;
  EXPECT_EQ(read_at_most((folder / "none").string(), 10).error().code, Errc::NotFound);
  EXPECT_EQ(read_at_most(folder.path().string(), 10).error().code, Errc::System);
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
