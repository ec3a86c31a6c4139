#include "drivers/falcon/arm_reference.hpp"

#include <gtest/gtest.h>

#include "drivers/falcon/exchange_pacer.hpp"
#include "drivers/falcon/find_model.hpp"

namespace thimble::falcon {
namespace {

using std::chrono::milliseconds;

class ArmReferenceTest : public testing::Test {
 protected:
  bool report(int counts, bool is_homed = true, Duration after = milliseconds(2)) {
    RunReport said;
    said.encoder_counts.fill(static_cast<std::int16_t>(counts));
    said.homed = is_homed ? wire::kAllHomed : 0;
    return sut_.on_report(said, after);
  }
  void home() {
    for (int i = 0; i <= ArmReference::kHomedReports; ++i) EXPECT_TRUE(report(0));
    ASSERT_TRUE(sut_.is_known());
  }
  ArmReference sut_{*find_model("falcon")};
};

TEST_F(ArmReferenceTest, KnowsNothingBeforeTheFirstReport) {
  EXPECT_EQ(sut_.state(), CalibrationState::Unknown);
  report(0, false);
  EXPECT_EQ(sut_.state(), CalibrationState::NeedsUser);
}

TEST_F(ArmReferenceTest, OneGoodReportMayBeABrokenOne) {
  for (int round = 0; round < 5; ++round) {
    for (int i = 1; i < ArmReference::kHomedReports; ++i) report(0);
    EXPECT_FALSE(sut_.is_known());
    report(0, false);
  }
  home();
}

// The encoders jump to their origins as the last bit rises: that report's numbers may be of either
// side.
TEST_F(ArmReferenceTest, CountsFromTheJumpToTheOriginOn) {
  report(5000, false);
  report(5000);
  report(0);
  for (int i = 1; i < ArmReference::kHomedReports; ++i) {
    report(0);
    EXPECT_FALSE(sut_.is_known()) << i;
  }
  report(0);
  EXPECT_TRUE(sut_.is_known());
}

// 1050 rad/s are 214 counts in a millisecond, and a report may be a millisecond old.
TEST_F(ArmReferenceTest, AMotorsOwnSpeedIsNoJump) {
  home();
  int counts = 0;
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(report(counts += 600));
  EXPECT_FALSE(report(counts + 700));
  EXPECT_FALSE(sut_.is_known());
}

TEST_F(ArmReferenceTest, KnownItDoesNotNeedTheBits) {
  home();
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(report(i, false));
  EXPECT_TRUE(sut_.is_known());
}

TEST_F(ArmReferenceTest, AGapIsLikeAnotherFirmware) {
  home();
  EXPECT_TRUE(report(0, true, ArmReference::kLongestGap));
  EXPECT_FALSE(report(0, true, ArmReference::kLongestGap + milliseconds(1)));
  EXPECT_FALSE(sut_.is_known());
  home();
}

TEST_F(ArmReferenceTest, ForgettingIsABeginning) {
  home();
  sut_.forget();
  EXPECT_EQ(sut_.state(), CalibrationState::Unknown);
  EXPECT_TRUE(report(9000)) << "nothing to jump from";
  for (int i = 1; i < ArmReference::kHomedReports; ++i) report(9000);
  EXPECT_TRUE(sut_.is_known());
}

// A servo of 1 kHz and an arm that loses one reply in `one_in`: how many requests are under way,
// and how long the longest pause between two of them was.
struct Course {
  int most_under_way{0};
  int replies{0};
  Duration longest_pause{};
};
Course run_exchange(int answer_ms, int one_in) {
  ExchangePacer sut;
  Course course;
  std::vector<int> due_ms;
  MonotonicTime last{};
  int requests = 0;
  for (int ms = 0; ms < 2000; ++ms) {
    const MonotonicTime now{milliseconds(ms)};
    while (!due_ms.empty() && due_ms.front() <= ms) {
      due_ms.erase(due_ms.begin());
      ++course.replies;
      sut.on_reply(now);
    }
    if (!sut.may_send(now)) continue;
    sut.on_sent(now);
    course.longest_pause = std::max(course.longest_pause, now - last);
    last = now;
    ++requests;
    if (one_in == 0 || requests % one_in != 0) due_ms.push_back(ms + answer_ms);
    course.most_under_way = std::max(course.most_under_way, static_cast<int>(due_ms.size()));
  }
  return course;
}

TEST(ExchangePacer, AskedOnceATickItIsAnsweredEverySecondOne) {
  const Course course = run_exchange(2, 0);
  EXPECT_EQ(course.most_under_way, 1);
  EXPECT_NEAR(course.replies, 1000, 2);
}

TEST(ExchangePacer, LostRepliesCostTheirTimeAndNoMore) {
  const Course course = run_exchange(2, 10);
  EXPECT_EQ(course.most_under_way, 1);
  EXPECT_LE(course.longest_pause, ExchangePacer::kPatience + milliseconds(2));
}

// As with a latency timer of 16 ms: asked every 4 ms (decision 0386), so that some pile up, and no
// more than the five that fit into its delay.
TEST(ExchangePacer, AnArmThatAnswersLateIsNotFlooded) {
  const Course course = run_exchange(16, 0);
  EXPECT_LE(course.most_under_way, 5);
  EXPECT_GT(course.replies, 100);
}

TEST(ExchangePacer, NobodyThereIsToldFromNobodyAsked) {
  ExchangePacer sut;
  const MonotonicTime start{std::chrono::hours(1)};
  EXPECT_FALSE(sut.is_deserted(start));
  sut.on_sent(start);
  sut.on_sent(start + milliseconds(400));
  EXPECT_FALSE(sut.is_deserted(start + milliseconds(499)));
  EXPECT_TRUE(sut.is_deserted(start + milliseconds(500)));
  sut.on_reply(start + milliseconds(500));
  EXPECT_FALSE(sut.is_deserted(start + std::chrono::hours(1)));
}

}  // namespace
}  // namespace thimble::falcon
