#include "daemon/app/summary_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/support/small_disk.hpp"
#include "tests/support/temporary_folder.hpp"

namespace thimble::app {
namespace {

using testing::HasSubstr;

class SummaryFileTest : public testing::Test {
 protected:
  [[nodiscard]] std::string text() const {
    std::ifstream file(path_);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  testing_support::TemporaryFolder folder_;
  std::string path_{(folder_ / "summary.json").string()};
  SummaryFile sut_{path_};
};

TEST_F(SummaryFileTest, ReplacesWhatWasThereAtTheEndOnly) {
  folder_.write("summary.json", "of an earlier one, and longer");
  ASSERT_TRUE(sut_.prepare());
  EXPECT_EQ(text(), "of an earlier one, and longer");
  ASSERT_TRUE(sut_.write("new"));
  EXPECT_EQ(text(), "new");
}

TEST_F(SummaryFileTest, TakesBackWhatItMade) {
  ASSERT_TRUE(sut_.prepare());
  EXPECT_TRUE(std::filesystem::exists(path_));
  sut_.leave_out();
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(SummaryFileTest, LeavesWhatAnEarlierOneWroteWhereThereIsNone) {
  folder_.write("summary.json", "");  // be it empty
  ASSERT_TRUE(sut_.prepare());
  sut_.leave_out();
  EXPECT_TRUE(std::filesystem::exists(path_));
}

TEST_F(SummaryFileTest, RefusesAPlaceThatCannotBeWrittenAndSaysWhich) {
  const std::string pipe = (folder_ / "pipe").string();
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& place : {pipe, folder_.path().string(), path_ + "/below"}) {
    SummaryFile sut(place);
    const Result<void> prepared = sut.prepare();
    ASSERT_FALSE(prepared) << place;
    EXPECT_EQ(prepared.error().code, Errc::System);
    EXPECT_THAT(prepared.error().message, HasSubstr("could not be written to " + place));
    sut.leave_out();
  }
  EXPECT_TRUE(std::filesystem::exists(pipe));
}

TEST_F(SummaryFileTest, SaysThatTheDiskIsFull) {
  SummaryFile sut("/dev/full");
  ASSERT_TRUE(sut.prepare());
  const Result<void> written = sut.write("text");
  ASSERT_FALSE(written);
  EXPECT_THAT(written.error().message, HasSubstr("written to /dev/full: No space left on device"));
}

TEST_F(SummaryFileTest, ADiskThatBecomesFullLeavesTheEarlierOneWhole) {
  folder_.write("summary.json", "of an earlier one");
  ASSERT_TRUE(sut_.prepare());
  const testing_support::SmallDisk disk(1000);
  EXPECT_FALSE(sut_.write(std::string(2000, 'n')));
  EXPECT_EQ(text(), "of an earlier one");
}

TEST(SummaryFile, OfNoPathIsNone) {
  SummaryFile sut(std::nullopt);
  EXPECT_TRUE(sut.prepare());
  EXPECT_TRUE(sut.write("text"));
  sut.leave_out();
}

}  // namespace
}  // namespace thimble::app
