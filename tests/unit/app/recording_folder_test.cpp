#include "daemon/app/recording_folder.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <set>

#include "tests/rt/in_child_process.hpp"
#include "tests/support/small_disk.hpp"
#include "tests/support/temporary_folder.hpp"

namespace thimble::app {
namespace {

namespace fs = std::filesystem;

servo::FlightHeader header_of(const std::string& arm, FaultCode code = FaultCode::Estop) {
  return {arm, "sim:x", {code, {}, 1}};
}

class RecordingFolder : public ::testing::Test {
 protected:
  Result<StoredRecording> store(const std::string& arm, std::size_t frames = 3) {
    return store_recording(path, header_of(arm), std::vector<servo::ServoFrame>(frames));
  }
  // A file that was written so many minutes ago.
  void put(const std::string& name, int minutes_ago) const {
    std::ofstream(path + "/" + name) << "x";
    fs::last_write_time(path + "/" + name,
                        fs::file_time_type::clock::now() - std::chrono::minutes(minutes_ago));
  }
  [[nodiscard]] std::set<std::string> names() const {
    std::set<std::string> out;
    for (const auto& entry : fs::directory_iterator(path)) out.insert(entry.path().filename());
    return out;
  }

  testing_support::TemporaryFolder folder;
  std::string path = (folder / "flights").string();
};

TEST_F(RecordingFolder, NumbersOfAnArmGoUpAndNothingIsOverwritten) {
  for (const char* arm : {"a", "a", "a-1", "b", "a"}) ASSERT_TRUE(store(arm));
  EXPECT_EQ(names(), (std::set<std::string>{"flight-a-1-estop.csv", "flight-a-2-estop.csv",
                                            "flight-a-3-estop.csv", "flight-a-1-1-estop.csv",
                                            "flight-b-1-estop.csv"}));
  fs::remove(path + "/flight-a-1-estop.csv");
  EXPECT_EQ(store("a")->path, path + "/flight-a-4-estop.csv");
}

TEST_F(RecordingFolder, HoldsTheWholeRecording) {
  const std::vector<servo::ServoFrame> frames(3);
  const auto stored = store_recording(path, header_of("a"), frames);
  ASSERT_TRUE(stored);
  std::ifstream file(stored->path);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}),
            servo::format_flight(header_of("a"), frames));
}

TEST_F(RecordingFolder, ADiskThatBecomesFullLeavesNothingBehind) {
  ASSERT_TRUE(store("a"));
  const auto before = names();
  {
    const testing_support::SmallDisk disk(1000);
    const auto refused = store("a", 2000);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::System);
    EXPECT_NE(refused.error().message.find("flight-a-2-estop.csv: "), std::string::npos);
  }
  EXPECT_EQ(names(), before);
  EXPECT_TRUE(store("a", 2000));
}

TEST_F(RecordingFolder, APlaceThatCannotBeWrittenIsNamed) {
  std::ofstream(folder / "file") << "x";
  const std::string below = (folder / "file" / "below").string();
  const auto refused = store_recording(below, header_of("a"), {});
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find(below), std::string::npos);
}

TEST_F(RecordingFolder, SaysBeforeTheFirstThatNoneCanBeMade) {
  EXPECT_TRUE(check_recordings_can_be_made(folder.path().string()));
  EXPECT_TRUE(check_recordings_can_be_made(path + "/that/is/made"));
  EXPECT_FALSE(fs::exists(path)) << "looking makes nothing";
  std::ofstream(folder / "file") << "x";
  for (const char* below : {"file", "file/below"}) {
    EXPECT_FALSE(check_recordings_can_be_made((folder / below).string())) << below;
  }
}

TEST_F(RecordingFolder, SaysWhichFolderTakesNone) {
  fs::create_directory(path);
  ASSERT_EQ(::chmod(folder.path().c_str(), 0755), 0);
  ASSERT_EQ(::chmod(path.c_str(), 0555), 0);
  const std::string said = test::in_child_process(test::Rights::None, [this] {
    std::string all;
    for (const std::string& place : {path, path + "/below"}) {
      const Result<void> checked = check_recordings_can_be_made(place);
      all += (checked ? "well" : checked.error().message) + "; ";
    }
    return all;
  });
  EXPECT_EQ(said, path + ": Permission denied; " + path + ": Permission denied; ");
}

TEST_F(RecordingFolder, KeepsTheNewestAndTouchesNothingThatIsNotOurs) {
  fs::create_directories(path);
  for (int i = 1; i <= 70; ++i) put("flight-a-" + std::to_string(i) + "-overspeed.csv", 100 - i);
  const std::set<std::string> others = {"flight-notes.csv",
                                        "flight-a-1-holiday.csv",
                                        "flight-a-01-estop.csv",
                                        "flight-a-1-estop.csv.bak",
                                        "notes.txt",
                                        ".flight.part"};
  for (const std::string& name : others) put(name, 10'000);
  fs::create_directory(path + "/flight-a-800-estop.csv");
  fs::create_symlink("notes.txt", path + "/flight-b-900-estop.csv");

  const auto stored = store("a");
  ASSERT_TRUE(stored);
  EXPECT_EQ(stored->removed, 39U);
  EXPECT_EQ(stored->path, path + "/flight-a-801-estop.csv");
  const auto left = names();
  for (int i = 1; i <= 70; ++i) {
    EXPECT_EQ(left.contains("flight-a-" + std::to_string(i) + "-overspeed.csv"), i > 39) << i;
  }
  for (const std::string& name : others) EXPECT_TRUE(left.contains(name)) << name;
  EXPECT_EQ(left.size(), kMaxRecordings + others.size() + 2);
  EXPECT_EQ(store("b")->removed, 0U) << "another arm's";
}

TEST_F(RecordingFolder, AnArmThatStopsAgainAndAgainTakesNothingFromTheOthers) {
  ASSERT_TRUE(store("quiet"));
  ASSERT_TRUE(store("wild-1"));
  for (std::size_t i = 0; i < 2 * kMaxRecordings; ++i) ASSERT_TRUE(store("wild"));
  const auto left = names();
  EXPECT_TRUE(left.contains("flight-quiet-1-estop.csv"));
  EXPECT_TRUE(left.contains("flight-wild-1-1-estop.csv"));
  EXPECT_EQ(left.size(), kMaxRecordings + 2);
}

TEST_F(RecordingFolder, TheOneJustWrittenIsTheNewestWhateverTheClockSays) {
  fs::create_directories(path);
  for (int i = 1; i <= 32; ++i) put("flight-a-" + std::to_string(i) + "-estop.csv", -60 - i);
  const auto stored = store("a");
  ASSERT_TRUE(stored);
  EXPECT_TRUE(fs::exists(stored->path));
  EXPECT_EQ(stored->removed, 1U);
}

TEST_F(RecordingFolder, LeavesTheNameToWhoIsWritingItAndClearsUpAfterTheDead) {
  fs::create_directories(path);
  put(".flight-a-1-estop.csv.part", 0);
  put(".flight-a-2-estop.csv.part", 61);
  EXPECT_EQ(store("a")->path, path + "/flight-a-3-estop.csv");
  EXPECT_EQ(names(), (std::set<std::string>{".flight-a-1-estop.csv.part", "flight-a-3-estop.csv"}));
}

TEST(RecordingName, IsReadBackForEveryFault) {
  for (std::size_t code = 0; code < kFaultCodeCount; ++code) {
    const std::string word(to_string(static_cast<FaultCode>(code)));
    EXPECT_EQ(parse_recording_name("flight-left-2-17-" + word + ".csv"),
              (RecordingName{"left-2", 17}));
  }
}

TEST(RecordingName, ParsingIsTotalAndGivesOnlyWhatWouldBeWritten) {
  std::mt19937 random(12);
  const std::vector<std::string> pieces = {"flight-", "a",    "-",    "1",     "0",  "99999999999",
                                           "-estop",  ".csv", ".csv", "estop", "\n", "/"};
  int good = 0;
  for (int i = 0; i < 200'000; ++i) {
    std::string text = random() % 2 == 0 ? "flight-" : "";
    for (std::size_t n = random() % 7; n > 0; --n) text += pieces[random() % pieces.size()];
    if (random() % 2 == 0) text += "-estop.csv";
    const auto name = parse_recording_name(text);
    if (!name) continue;
    ++good;
    EXPECT_EQ(name->arm.find_first_of("\n/"), std::string::npos);
    EXPECT_EQ("flight-" + name->arm + "-" + std::to_string(name->number) + "-estop.csv", text);
  }
  EXPECT_GT(good, 100);
}

}  // namespace
}  // namespace thimble::app
