#include "daemon/session/arm_seeker.hpp"

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

struct ArmSeekerTest : testing::Test {
  Plugins plugins;
  sim::VirtualClock clock;
  sim::SimEnumerator buses{clock};
  test::PostponedExecutor work;
  ArmSeeker sut{work};

  ArmSeekerTest() {
    auto model = plugins.models.find("phantom-vintage")->create_hid({.amplifier_max_a = 3});
    EXPECT_TRUE(buses.plug({"hid:left"}, *std::move(model)));
  }
  Search search() {
    config::ArmConfig arm;
    arm.name = "left";
    arm.device = "hid:left";
    arm.model = "phantom-vintage";
    arm.amplifier_max_a = 3;
    return {arm, &buses, &plugins.drivers, &clock};
  }
  bool is_open() { return !buses.open_hid({"hid:left"}); }
};

TEST_F(ArmSeekerTest, GivesAnArmWhenItHasBeenOpenedAndNotBefore) {
  EXPECT_FALSE(sut.is_under_way());
  sut.begin(search(), clock.now());
  EXPECT_TRUE(sut.is_under_way());
  EXPECT_FALSE(sut.take()) << "nobody waits for it";
  EXPECT_FALSE(is_open());
  work.do_all();
  EXPECT_TRUE(sut.is_under_way()) << "until it is taken";
  const auto sought = sut.take();
  ASSERT_TRUE(sought);
  EXPECT_EQ(sought->there->address.text, "hid:left");
  ASSERT_TRUE(sought->device) << sought->device.error().message;
  EXPECT_EQ((*sought->device)->capabilities().model, "phantom-vintage");
  EXPECT_FALSE(sut.is_under_way());
  EXPECT_FALSE(sut.take()) << "once";
}

TEST_F(ArmSeekerTest, SaysWhatThereIsInsteadOfAnArmThatIsNotThere) {
  Search other = search();
  other.arm.device = "hid:right";
  sut.begin(other, clock.now());
  work.do_all();
  const auto sought = sut.take();
  EXPECT_FALSE(sought->there);
  EXPECT_EQ(sought->device.error().code, Errc::NotFound);
  EXPECT_THAT(sought->device.error().message, HasSubstr("there are: hid:left"));
}

TEST_F(ArmSeekerTest, AMereLookOpensNothing) {
  Search look = search();
  look.is_look = true;
  sut.begin(look, clock.now());
  work.do_all();
  const auto sought = sut.take();
  EXPECT_TRUE(sought->there);
  EXPECT_EQ(sought->device.value(), nullptr);
  EXPECT_FALSE(is_open());
}

TEST_F(ArmSeekerTest, ToAStrangerInTheArmsPlaceNothingIsSent) {
  Search again = search();
  again.left = buses.list().front();
  again.left->serial_number = "another";
  sut.begin(again, clock.now());
  work.do_all();
  const auto sought = sut.take();
  EXPECT_TRUE(sought->there);
  EXPECT_THAT(sought->device.error().message, HasSubstr("another device stands in the place"));
  EXPECT_FALSE(is_open());
}

TEST_F(ArmSeekerTest, ThatLastsIsToldOfForAsLongAsItDoesAndOnceToTheLog) {
  EXPECT_EQ(sut.lateness(clock.now()), "");
  const MonotonicTime begun = clock.now();
  const auto after = [&](int ms) { return begun + std::chrono::milliseconds(ms); };
  sut.begin(search(), begun);
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
  sut.begin(search(), after(8000));
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

TEST_F(ArmSeekerTest, WhatIsThrownIsAnErrorOfAnArmThatMayBeThere) {
  ThrowingBus broken;
  Search here = search();
  here.buses = &broken;
  sut.begin(here, clock.now());
  work.do_all();
  const auto sought = sut.take();
  ASSERT_TRUE(sought);
  EXPECT_EQ(sought->there->address.text, "hid:left") << "nobody is told to plug it in";
  EXPECT_EQ(sought->device.error(), (Error{Errc::System, "hid:left: out of luck"}));
}

TEST_F(ArmSeekerTest, WhatIsOfNoUseIsClosedByTheWork) {
  sut.begin(search(), clock.now());
  work.do_all();
  sut.give_back(*sut.take());
  EXPECT_TRUE(is_open()) << "here nothing is closed";
  work.do_all();
  EXPECT_FALSE(is_open());
}

TEST_F(ArmSeekerTest, WhatNobodyTookIsClosedByTheWork) {
  for (const bool is_done : {true, false}) {
    auto seeker = std::make_unique<ArmSeeker>(work);
    seeker->begin(search(), clock.now());
    if (is_done) work.do_all();
    seeker.reset();
    work.do_all();
    EXPECT_FALSE(is_open()) << is_done;
  }
}

}  // namespace
}  // namespace thimble::session
