#include "daemon/devices/returned_arm.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

namespace thimble::devices {
namespace {

using testing::HasSubstr;

bus::BusDeviceInfo some_arm() {
  bus::BusDeviceInfo info;
  info.address = {"hid:1-2"};
  info.kind = bus::BusKind::Hid;
  info.vendor_id = 0x16c0;
  info.product_id = 0x0486;
  info.manufacturer = "somebody";
  info.serial_number = "A1";
  info.input_report_bytes = info.output_report_bytes = 64;
  return info;
}

TEST(ReturnedArm, IsTheSameWhateverItsMakerIsCalledNow) {
  bus::BusDeviceInfo returned = some_arm();
  EXPECT_TRUE(check_same_device(some_arm(), returned));
  returned.manufacturer = "somebody else";
  returned.product = "an arm";
  EXPECT_TRUE(check_same_device(some_arm(), returned));
  EXPECT_TRUE(check_same_limits({}, {}));
}

TEST(ReturnedArm, IsAnotherWithAnyOtherMarkAndTheSentenceNamesIt) {
  const auto message_with = [](const std::function<void(bus::BusDeviceInfo&)>& change) {
    bus::BusDeviceInfo returned = some_arm();
    change(returned);
    const Result<void> sut = check_same_device(some_arm(), returned);
    return sut ? std::string("the same") : sut.error().message;
  };
  EXPECT_THAT(message_with([](auto& i) { i.vendor_id = 0x1234; }), HasSubstr("1234:0486 instead"));
  EXPECT_THAT(message_with([](auto& i) { i.product_id = 6; }), HasSubstr("16c0:0006 instead"));
  EXPECT_THAT(message_with([](auto& i) { i.serial_number = "B2"; }),
              HasSubstr("serial number B2 instead of serial number A1"));
  EXPECT_THAT(message_with([](auto& i) { i.serial_number = ""; }), HasSubstr("no serial number"));
  EXPECT_THAT(message_with([](auto& i) { i.input_report_bytes = 14; }), HasSubstr("form"));
  EXPECT_THAT(message_with([](auto& i) { i.output_report_bytes = 14; }), HasSubstr("form"));
  EXPECT_THAT(message_with([](auto& i) { i.kind = bus::BusKind::Usb; }), HasSubstr("form"));
}

TEST(ReturnedArm, WithAnyOtherLimitIsAnother) {
  const auto is_refused = [](const std::function<void(HapticCapabilities&)>& change) {
    HapticCapabilities returned;
    change(returned);
    return !check_same_limits({}, returned).has_value();
  };
  EXPECT_TRUE(is_refused([](auto& c) { c.model = "other"; }));
  EXPECT_TRUE(is_refused([](auto& c) { c.peak_force_newton = 1; }));
  EXPECT_TRUE(is_refused([](auto& c) { c.peak_current_a[2] = 1; }));
  EXPECT_TRUE(is_refused([](auto& c) { c.continuous_current_a[0] = 1; }));
  EXPECT_TRUE(is_refused([](auto& c) { c.device_watchdog = std::chrono::milliseconds(1); }));
}

}  // namespace
}  // namespace thimble::devices
