#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/campaign/good_course.hpp"

// As invariants_test.cpp: seen to hold on a good course and to break on a planted breach.
namespace thimble::campaign {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

TEST(Progress, HoldsOnAGoodCourse) { EXPECT_EQ(GoodCourse(&make_progress).broken(), ""); }

TEST(Progress, SeesATickThatIsLeftOutAndTimeThatStandsStill) {
  GoodCourse skipped(&make_progress);
  skipped.run(1, [](Observation& now) { ++now.servo.frame.tick; });
  EXPECT_THAT(skipped.broken(), HasSubstr("one by one"));
  GoodCourse still(&make_progress);
  still.run(1,
            [](Observation& now) { now.servo.frame.now = now.servo.frame.now - milliseconds(1); });
  EXPECT_THAT(still.broken(), HasSubstr("time advances"));
}

TEST(Progress, SeesThatNoSampleIsTaken) {
  const auto deaf = [](Observation& now) { now.servo.frame.read_status = IoStatus::NoData; };
  GoodCourse course(&make_progress);
  course.run(1200);  // beyond the start of the firmware
  course.run(50, deaf);
  EXPECT_EQ(course.broken(), "");
  course.run(1, deaf);
  EXPECT_THAT(course.broken(), HasSubstr("no sample"));
}

TEST(Progress, ExcusesADisturbedCable) {
  GoodCourse course(&make_progress);
  course.run(1200);
  course.run(500, [](Observation& now) {
    now.servo.frame.read_status = IoStatus::NoData;
    now.cable_ok_since = now.servo.frame.now;
  });
  EXPECT_EQ(course.broken(), "");
}

// An arm that may have to be found and loaded again.
std::unique_ptr<Invariant> make_progress_on_usb(const Bounds& bounds) {
  Bounds usb = bounds;
  usb.is_tapped = false;
  usb.boot = usb.silence = std::chrono::seconds(12);
  return make_progress(usb);
}

void deaf(Observation& now) { now.servo.frame.read_status = IoStatus::NoData; }

TEST(Progress, SeesThatAnArmOnUsbIsNotFoundAgainWhoseFirmwareRuns) {
  GoodCourse course(&make_progress_on_usb);
  course.now.truth.is_amplifier_on = true;
  course.run(1200);
  course.run(600, [](Observation& now) {
    deaf(now);
    now.cable_ok_since = now.servo.frame.now;
  });
  course.run(110, &deaf);
  EXPECT_EQ(course.broken(), "") << "a zero every 50 ms, and 50 ms to answer";
  course.run(1, &deaf);
  EXPECT_THAT(course.broken(), HasSubstr("no sample"));
}

TEST(Progress, GrantsAnArmOnUsbWithoutFirmwareItsUploadAndNoMore) {
  GoodCourse course(&make_progress_on_usb);
  course.run(13'000);
  EXPECT_NEAR(static_cast<double>(course.judged().ticks_due_on_usb), 600 + 1000 - 50, 2);
  course.run(1, [](Observation& now) { now.cable_ok_since = now.servo.frame.now; });
  course.run(12'049, &deaf);
  EXPECT_EQ(course.broken(), "");
  course.run(2, &deaf);
  EXPECT_THAT(course.broken(), HasSubstr("no sample"));
}

TEST(Progress, SeesThatNoReplyIsUsed) {
  GoodCourse course(&make_progress);
  course.run(60, [](Observation& now) { now.servo.frame.is_frozen = true; });
  EXPECT_THAT(course.broken(), HasSubstr("no reply"));
}

TEST(Progress, ExpectsNoReplyOfAWorldWithoutRoom) {
  const auto frozen = [](Observation& now) { now.servo.frame.is_frozen = true; };
  GoodCourse course(&make_progress);
  course.run(500, [&](Observation& now) {
    frozen(now);
    now.replies_ok_since = now.servo.frame.now;
  });
  course.run(50, frozen);
  EXPECT_EQ(course.broken(), "");
  course.run(10, frozen);
  EXPECT_THAT(course.broken(), HasSubstr("no reply"));
}

TEST(Progress, SeesAnEditThatIsLeftLying) {
  GoodCourse course(&make_progress);
  const MonotonicTime asked = course.now.servo.frame.now;
  const auto waits = [asked](Observation& now) { now.edits_ok_since = asked; };
  course.run(50, waits);
  EXPECT_EQ(course.broken(), "");
  course.run(1, waits);
  EXPECT_THAT(course.broken(), HasSubstr("an edit waits"));
}

TEST(Progress, SeesAnArmThatStaysLost) {
  const auto lost = [](Observation& now) { now.servo.frame.state = OperatingState::Lost; };
  GoodCourse course(&make_progress);
  course.run(2000, lost);
  EXPECT_EQ(course.broken(), "");
  course.run(60, lost);
  EXPECT_THAT(course.broken(), HasSubstr("stays lost"));
}

}  // namespace
}  // namespace thimble::campaign
