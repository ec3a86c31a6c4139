#include "daemon/app/recording_writer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <future>
#include <memory>
#include <stdexcept>
#include <string>

#include "tests/support/temporary_folder.hpp"

namespace thimble::app {
namespace {

constexpr Duration kNoPatience{0};
constexpr Duration kLong = std::chrono::seconds(60);  // only says when a test gives up

session::Recording recording_of(const std::string& arm) {
  return {{arm, "sim:x", {FaultCode::Estop, {}, 1, 1}}, {}};
}

Result<StoredRecording> stored_as_its_arm(const session::Recording& recording) {
  return StoredRecording{"/flights/" + recording.header.arm, 0};
}

// A disk that takes nothing until it is told to. It outlives who writes to it, as a disk does.
class StuckDisk {
 public:
  RecordingWriter::Store store() {
    return [state = state_](const session::Recording& recording) {
      state->begun.set_value();
      state->released.get_future().wait();
      Result<StoredRecording> stored = stored_as_its_arm(recording);
      return stored;
    };
  }
  void wait_until_begun() { state_->begun.get_future().wait(); }
  void release() { state_->released.set_value(); }

 private:
  struct State {
    std::promise<void> begun;
    std::promise<void> released;
  };
  std::shared_ptr<State> state_ = std::make_shared<State>();
};

TEST(RecordingWriter, TellsOfEachRecordingInTheirOrderOnce) {
  RecordingWriter sut(stored_as_its_arm, 1);
  for (const char* arm : {"right", "left", "third"}) sut.write(recording_of(arm));
  ASSERT_TRUE(sut.flush(kLong));
  const auto outcomes = sut.finished();
  ASSERT_EQ(outcomes.size(), 3U);
  EXPECT_EQ(outcomes[0].path, "/flights/right");
  EXPECT_EQ(outcomes[2].arm, "third");
  EXPECT_TRUE(sut.finished().empty());
}

TEST(RecordingWriter, DoubtsAFolderThatTakesNoneOnce) {
  const testing_support::TemporaryFolder folder;
  RecordingWriter good(folder.path().string(), 1);
  RecordingWriter bad(folder.write("file", "x"), 1);
  ASSERT_TRUE(good.flush(kLong) && bad.flush(kLong));
  EXPECT_EQ(good.take_doubt(), std::nullopt);
  EXPECT_EQ(bad.take_doubt(), (folder / "file").string() + ": Not a directory");
  EXPECT_EQ(bad.take_doubt(), std::nullopt);
  EXPECT_TRUE(bad.finished().empty()) << "a doubt is no recording that was lost";
}

TEST(RecordingWriter, HasNothingToFlushAtFirst) {
  RecordingWriter sut(stored_as_its_arm, 1);
  EXPECT_TRUE(sut.flush(kNoPatience));
}

TEST(RecordingWriter, TellsWhyOneWasNotWritten) {
  const auto store = [](const session::Recording& recording) -> Result<StoredRecording> {
    if (recording.header.arm == "right") return fail(Errc::System, "the disk is full");
    throw std::runtime_error("no memory");
  };
  RecordingWriter sut(store, 2);
  sut.write(recording_of("right"));
  sut.write(recording_of("left"));
  ASSERT_TRUE(sut.flush(kLong));
  const auto outcomes = sut.finished();
  ASSERT_EQ(outcomes.size(), 2U);
  EXPECT_EQ(outcomes[0].error, "the disk is full");
  EXPECT_EQ(outcomes[1].error, "no memory");
}

TEST(RecordingWriter, AStuckDiskIsToldAndDoneWithOnceItMovesAgain) {
  StuckDisk disk;
  RecordingWriter sut(disk.store(), 1);
  sut.write(recording_of("right"));
  disk.wait_until_begun();
  EXPECT_FALSE(sut.flush(kNoPatience));
  EXPECT_TRUE(sut.finished().empty());
  disk.release();
  EXPECT_TRUE(sut.flush(kLong));
  EXPECT_EQ(sut.finished().size(), 1U);
}

// As many as there are arms may stop at once, and four of fewer; whatever stops while nothing moves
// costs no memory.
class StuckDiskOfArms : public ::testing::TestWithParam<std::size_t> {};

TEST_P(StuckDiskOfArms, HasOneOfEachArmWaitAndTheRestIsToldAsLostAtOnce) {
  const std::size_t kept = std::max<std::size_t>(GetParam(), 4);
  std::promise<void> release;
  const auto store = [released = release.get_future().share()](const session::Recording& one) {
    released.wait();
    return stored_as_its_arm(one);
  };
  RecordingWriter sut(store, GetParam());
  for (std::size_t i = 0; i < kept; ++i) sut.write(recording_of("kept"));
  EXPECT_TRUE(sut.finished().empty());
  for (int i = 0; i < 100; ++i) sut.write(recording_of("lost"));
  const auto lost = sut.finished();
  EXPECT_EQ(lost.size(), 100U);
  for (const RecordingWriter::Outcome& one : lost) {
    EXPECT_EQ(one.arm, "lost");
    EXPECT_EQ(one.path, "");
    EXPECT_EQ(one.error,
              "the disk still has not taken the " + std::to_string(kept) + " recordings before it");
  }
  release.set_value();
  ASSERT_TRUE(sut.flush(kLong));
  EXPECT_EQ(sut.finished().size(), kept);
  sut.write(recording_of("later"));
  ASSERT_TRUE(sut.flush(kLong));
  EXPECT_EQ(sut.finished().at(0).path, "/flights/later") << "there is room again";
}

INSTANTIATE_TEST_SUITE_P(Arms, StuckDiskOfArms, ::testing::Values(0, 1, 4, 5, 32));

// It would hang here for ever.
TEST(RecordingWriter, AStuckDiskKeepsNobodyFromEnding) {
  StuckDisk disk;
  {
    RecordingWriter sut(disk.store(), 1);
    sut.write(recording_of("right"));
    sut.write(recording_of("left"));  // is not begun: the disk would take the second promise ill
    disk.wait_until_begun();
    EXPECT_FALSE(sut.flush(kNoPatience)) << "it is stuck when its end comes";
  }
  disk.release();  // whoever is left behind touches nothing that is gone
}

}  // namespace
}  // namespace thimble::app
