#include <gtest/gtest.h>

#include "tests/unit/falcon/falcon_device_fixture.hpp"

// What the driver does about an arm that says nothing.
namespace thimble::falcon {
namespace {

// It has no watchdog: what it holds while nothing passes the cable is taken away by a zero alone.
TEST_F(FalconDeviceTest, AnArmThatFellSilentIsSentZerosBeforeAnythingElseIsTried) {
  home();
  int ms = 0;
  for (write(1, 0, 0); ms < 1000 && sent() != Counts{0, 0, 0}; ++ms) {
    pass();
    write(1, 0, 0);
  }
  EXPECT_EQ(ms, 500) << "when nobody answered for so long";
  const std::size_t before = packets();
  for (; ms < 5400; ++ms) {
    pass();
    write(1, 0, 0);
    ASSERT_EQ(sent(), (Counts{0, 0, 0}));
  }
  EXPECT_EQ(packets() - before, 98U) << "one each 50 ms";
  EXPECT_EQ(script_.requests.size(), 4U) << "its bridge is set";
  home();
}

TEST_F(FalconDeviceTest, ARequestThatNeverEndsIsAnsweredWithZerosAndAHandleThatIsGivenUp) {
  script_.ends_requests = false;
  int ms = 0;
  for (; ms < 2000 && write(1, 0, 0) != IoStatus::Disconnected; ++ms) {
    if (pass() == IoStatus::Disconnected) break;
  }
  EXPECT_NEAR(ms, 500, 3);
  EXPECT_EQ(script_.requests.size(), 1U);
  EXPECT_GE(packets(), 10U) << "a zero every 50 ms";
  for (const test::Bytes& packet : script_.submitted) {
    EXPECT_EQ(test::reports_in(packet).at(0).encoder_counts, (Counts{0, 0, 0}));
  }
  script_.request_ends.push_back(bus::UsbOutcome::Done);
  EXPECT_EQ(pass(), IoStatus::Disconnected) << "for good";
  EXPECT_EQ(write(1, 0, 0), IoStatus::Disconnected);
}

TEST_F(FalconDeviceTest, NobodyWhoAnswersIsLookedForFromTheBoot) {
  home();
  for (int ms = 0; ms < 5800; ++ms) {
    write(1, 0, 0);
    pass();
  }
  EXPECT_EQ(script_.requests.size(), 4U);
  for (int ms = 0; ms < 5000; ++ms) {  // it rests without an image
    write(1, 0, 0);
    pass();
  }
  EXPECT_EQ(script_.requests.size(), 8U) << "the settings of run mode a second time";
  EXPECT_FALSE(sut_->calibration_instruction().empty());
  home();
}

TEST_F(FalconDeviceTest, SilenceThatNobodyBrokeIsNoDesertion) {
  home();
  write();
  reply(kSomewhere);
  for (int ms = 0; ms < 3000; ++ms) pass();
  write();
  EXPECT_EQ(reply(kSomewhere), IoStatus::Ok);
  EXPECT_EQ(script_.requests.size(), 4U);
}

}  // namespace
}  // namespace thimble::falcon
