#include "daemon/session/arm_opening.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "daemon/session/plugins.hpp"
#include "sim/bus/sim_enumerator.hpp"
#include "sim/time/virtual_clock.hpp"
#include "tests/support/postponed_executor.hpp"

namespace thimble::session {
namespace {

using testing::HasSubstr;

struct ArmOpenerTest : testing::Test {
  Plugins plugins;
  sim::VirtualClock clock;
  sim::SimEnumerator buses{clock};
  test::PostponedExecutor work;
  ArmOpener sut{work};

  ArmOpenerTest() {
    auto model = plugins.models.find("phantom-vintage")->create_hid({.amplifier_max_a = 3});
    EXPECT_TRUE(buses.plug({"hid:left"}, *std::move(model)));
  }
  OpenRequest request() {
    config::ArmConfig arm;
    arm.name = "left";
    arm.device = "hid:left";
    arm.model = "phantom-vintage";
    arm.amplifier_max_a = 3;
    return {arm, &buses, &plugins.drivers, &clock};
  }
  bool is_open() { return !buses.open_hid({"hid:left"}); }
};

TEST_F(ArmOpenerTest, GivesAnArmWhenItHasBeenOpenedAndNotBefore) {
  EXPECT_FALSE(sut.is_under_way());
  sut.begin(request(), clock.now());
  EXPECT_TRUE(sut.is_under_way());
  EXPECT_FALSE(sut.take()) << "nobody waits for it";
  EXPECT_FALSE(is_open());
  work.do_all();
  EXPECT_TRUE(sut.is_under_way()) << "until it is taken";
  const auto outcome = sut.take();
  ASSERT_TRUE(outcome);
  const auto* const opened = std::get_if<Opened>(&*outcome);
  ASSERT_NE(opened, nullptr);
  EXPECT_EQ(opened->info.address.text, "hid:left");
  EXPECT_EQ(opened->device->capabilities().model, "phantom-vintage");
  EXPECT_FALSE(sut.is_under_way());
  EXPECT_FALSE(sut.take()) << "once";
}

TEST_F(ArmOpenerTest, SaysWhatThereIsInsteadOfAnArmThatIsNotThere) {
  OpenRequest other = request();
  other.arm.device = "hid:right";
  sut.begin(other, clock.now());
  work.do_all();
  const auto outcome = sut.take();
  const Error why = std::get<NotThere>(*outcome).why;
  EXPECT_EQ(why.code, Errc::NotFound);
  EXPECT_THAT(why.message, HasSubstr("there are: hid:left"));
}

TEST_F(ArmOpenerTest, AMereLookOpensNothing) {
  OpenRequest look = request();
  look.probe_only = true;
  sut.begin(look, clock.now());
  work.do_all();
  const auto outcome = sut.take();
  EXPECT_TRUE(std::holds_alternative<Probed>(*outcome));
  EXPECT_FALSE(is_open());
}

TEST_F(ArmOpenerTest, ToAStrangerInTheArmsPlaceNothingIsSent) {
  OpenRequest again = request();
  again.left = buses.list().front();
  again.left->serial_number = "another";
  sut.begin(again, clock.now());
  work.do_all();
  const auto outcome = sut.take();
  EXPECT_THAT(std::get<Refused>(*outcome).why.message,
              HasSubstr("another device stands in the place"));
  EXPECT_FALSE(is_open());
}

TEST_F(ArmOpenerTest, ThatLastsIsToldOfForAsLongAsItDoesAndOnceToTheLog) {
  EXPECT_EQ(sut.lateness(clock.now()), "");
  const MonotonicTime begun = clock.now();
  const auto after = [&](int ms) { return begun + std::chrono::milliseconds(ms); };
  sut.begin(request(), begun);
  EXPECT_EQ(sut.lateness(after(1999)), "");
  EXPECT_TRUE(sut.tell_lateness(after(1999)));
  EXPECT_EQ(sut.lateness(after(2000)),
            "hid:left: the kernel has been opening it for 2 s: plug it in anew");
  const Result<void> told = sut.tell_lateness(after(2000));
  ASSERT_FALSE(told);
  EXPECT_EQ(told.error().message, sut.lateness(after(2000)));
  EXPECT_TRUE(sut.tell_lateness(after(2020))) << "once";
  EXPECT_THAT(sut.lateness(after(7999)), HasSubstr("for 7 s"));
  work.do_all();
  static_cast<void>(sut.take());
  EXPECT_EQ(sut.lateness(after(8000)), "");
  sut.begin(request(), after(8000));
  EXPECT_TRUE(sut.tell_lateness(after(9000)));
  EXPECT_FALSE(sut.tell_lateness(after(10000))) << "another one";
}

// As a library or a plugin may; it would end the process.
class ThrowingBus final : public bus::BusEnumerator {
 public:
  [[nodiscard]] std::vector<bus::BusDeviceInfo> list() override {
    throw std::runtime_error("out of luck");
  }
  [[nodiscard]] std::optional<bus::BusEvent> poll_event() override { return std::nullopt; }
  [[nodiscard]] Result<std::unique_ptr<bus::HidDevice>> open_hid(
      const bus::DeviceAddress&) override {
    throw std::runtime_error("out of luck");
  }
};

TEST_F(ArmOpenerTest, WhatIsThrownIsAnErrorOfAnArmThatMayBeThere) {
  ThrowingBus broken;
  OpenRequest here = request();
  here.buses = &broken;
  sut.begin(here, clock.now());
  work.do_all();
  const auto outcome = sut.take();
  ASSERT_TRUE(outcome);
  // Not that it is gone: nobody is told to plug it in.
  EXPECT_EQ(std::get<Refused>(*outcome).why, (Error{Errc::System, "hid:left: out of luck"}));
}

TEST_F(ArmOpenerTest, WhatIsOfNoUseIsClosedByTheWork) {
  sut.begin(request(), clock.now());
  work.do_all();
  sut.give_back(*sut.take());
  EXPECT_TRUE(is_open()) << "here nothing is closed";
  work.do_all();
  EXPECT_FALSE(is_open());
}

TEST_F(ArmOpenerTest, WhatNobodyTookIsClosedByTheWork) {
  for (const bool is_done : {true, false}) {
    auto opener = std::make_unique<ArmOpener>(work);
    opener->begin(request(), clock.now());
    if (is_done) work.do_all();
    opener.reset();
    work.do_all();
    EXPECT_FALSE(is_open()) << is_done;
  }
}

// Its opening may end at any moment of the opener's end: neither is the last to hold the device.
TEST_F(ArmOpenerTest, WhatIsUnderWayWhenItEndsIsHeldByTheWorkUntilAfterTheOpening) {
  {
    ArmOpener opener(work);
    opener.begin(request(), clock.now());
  }
  work.do_one();
  EXPECT_TRUE(is_open()) << "the opening has ended, and what closes the device is still to come";
  work.do_one();
  EXPECT_FALSE(is_open());
  EXPECT_EQ(work.waiting(), 0U);
}

}  // namespace
}  // namespace thimble::session
