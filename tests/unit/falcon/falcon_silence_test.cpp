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

// The bridge itself is silent: not even empty packets come, but what is written leaves.
class FalconSilentPipe : public FalconDeviceTest {
 protected:
  FalconSilentPipe() {
    clock_ = &script_clock_;
    open();
  }
};

TEST_F(FalconSilentPipe, IsSentZerosByTheClock) {
  home();
  int ms = 0;
  for (write(1, 0, 0); ms < 1000 && sent() != Counts{0, 0, 0}; ++ms) {
    pass_silently();
    write(1, 0, 0);
  }
  EXPECT_NEAR(ms, 500, 1) << "as where empty packets come";
  const std::size_t before = packets();
  for (; ms < 5400; ++ms) {
    pass_silently();
    write(1, 0, 0);
    ASSERT_EQ(sent(), (Counts{0, 0, 0}));
  }
  EXPECT_NEAR(static_cast<double>(packets() - before), 98, 1) << "one each 50 ms";
  EXPECT_EQ(script_.requests.size(), 4U) << "its bridge is set";
  home();
}

TEST_F(FalconSilentPipe, GivesUpAHandleWhoseRequestNeverEnds) {
  script_.ends_requests = false;
  int ms = 0;
  for (; ms < 2000 && write(1, 0, 0) != IoStatus::Disconnected; ++ms) {
    if (pass_silently() == IoStatus::Disconnected) break;
  }
  EXPECT_NEAR(ms, 550, 3) << "silent for 50 ms, then as ever";
  EXPECT_GE(packets(), 10U) << "a zero every 50 ms";
}

TEST_F(FalconSilentPipe, OfWhichPacketsComeIsPacedByThemAlone) {
  home();
  write(1, 0, 0);
  const std::size_t sent_before = packets();
  for (int i = 0; i < 10; ++i) {  // 40 ms late each, and none of them says anything
    script_.now = script_.now + milliseconds(40);
    read();
    write(1, 0, 0);
    EXPECT_EQ(packets(), sent_before + static_cast<std::size_t>(i)) << "time stands still between";
    pass(milliseconds(5));
    write(1, 0, 0);
  }
}

TEST_F(FalconSilentPipe, ThatNobodyAskedAnythingIsNoDesertion) {
  home();
  write();
  reply(kSomewhere);
  for (int ms = 0; ms < 3000; ++ms) pass_silently();
  write();
  EXPECT_EQ(reply(kSomewhere), IoStatus::Ok);
  EXPECT_EQ(script_.requests.size(), 4U);
}

}  // namespace
}  // namespace thimble::falcon
