#include "drivers/phantom/phantom_driver.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "drivers/phantom/phantom_wire.hpp"
#include "tests/unit/phantom/scripted_hid.hpp"

namespace thimble::phantom {
namespace {

// A bus with one device, or with none that opens.
class OneDeviceBus final : public bus::BusEnumerator {
 public:
  std::vector<bus::BusDeviceInfo> list() override { return {}; }
  std::optional<bus::BusEvent> poll_event() override { return std::nullopt; }
  Result<std::unique_ptr<bus::HidDevice>> open_hid(const bus::DeviceAddress& address) override {
    opened.push_back(address.text);
    if (is_busy) return fail(Errc::Busy, "open elsewhere");
    return std::make_unique<ScriptedHid>(script);
  }
  HidScript script;
  std::vector<std::string> opened;
  bool is_busy{false};
};

bus::BusDeviceInfo mbed_at(std::string address) {
  bus::BusDeviceInfo info;
  info.address = {std::move(address)};
  info.kind = bus::BusKind::Hid;
  info.vendor_id = 0x1234;
  info.product_id = 0x0006;
  info.input_report_bytes = 14;
  info.output_report_bytes = 14;
  return info;
}

plugin::DriverSettings named_vintage() {
  plugin::DriverSettings settings;
  settings.model = "phantom-vintage";
  settings.amplifier_max_a = 3.0;
  settings.is_named_by_person = true;
  return settings;
}

class PhantomDriverTest : public testing::Test {
 protected:
  Errc refusal(const bus::BusDeviceInfo& info, const plugin::DriverSettings& settings) {
    const auto probed = sut->probe(info, settings);
    if (probed) return Errc::System;  // never given by probe()
    message = probed.error().message;
    OneDeviceBus buses;
    const auto opened = sut->open(buses, info, settings);
    EXPECT_FALSE(opened);
    EXPECT_TRUE(buses.opened.empty()) << "touched a device that it refuses";
    return probed.error().code;
  }
  bool says(std::string_view word) const { return message.find(word) != std::string::npos; }
  std::unique_ptr<plugin::Driver> sut = make_phantom_driver();
  std::string message;
};

TEST_F(PhantomDriverTest, TakesADeviceThatAPersonNamed) {
  EXPECT_EQ(sut->name(), "phantom");
  EXPECT_TRUE(sut->probe(mbed_at("hid:123"), named_vintage()));
  bus::BusDeviceInfo teensy = mbed_at("hid:123");
  teensy.vendor_id = 0x16c0;
  teensy.product_id = 0x0486;
  teensy.input_report_bytes = teensy.output_report_bytes = 64;
  EXPECT_TRUE(sut->probe(teensy, named_vintage()));
}

bus::BusDeviceInfo teensy_at(std::string address) {
  bus::BusDeviceInfo info;
  info.address = {std::move(address)};
  info.kind = bus::BusKind::Serial;
  info.vendor_id = 0x16c0;
  info.product_id = 0x0483;
  return info;
}

TEST_F(PhantomDriverTest, TakesASerialPortWithTheTeensysIdsThatAPersonNamed) {
  EXPECT_TRUE(sut->probe(teensy_at("serial:123"), named_vintage()));
  plugin::DriverSettings settings = named_vintage();
  settings.is_named_by_person = false;
  EXPECT_EQ(refusal(teensy_at("serial:123"), settings), Errc::Permission);
  EXPECT_TRUE(says("serial:123"));
  bus::BusDeviceInfo bare = teensy_at("usb:1-4");
  bare.kind = bus::BusKind::Usb;
  EXPECT_EQ(refusal(bare, named_vintage()), Errc::NotMine);
  bus::BusDeviceInfo other = teensy_at("serial:123");
  other.product_id = 0x0486;
  EXPECT_EQ(refusal(other, named_vintage()), Errc::NotMine);
}

TEST_F(PhantomDriverTest, OfASerialPortItWantsAnArmWhoseFirmwareSpeaksText) {
  plugin::DriverSettings settings = named_vintage();
  settings.model = "polhem-1";
  EXPECT_EQ(refusal(teensy_at("serial:123"), settings), Errc::InvalidArgument);
  EXPECT_TRUE(says("polhem-1"));
  EXPECT_TRUE(says("phantom-vintage, premium-1.5, woody-2015"));
  settings = named_vintage();
  settings.amplifier_max_a.reset();
  EXPECT_EQ(refusal(teensy_at("serial:123"), settings), Errc::InvalidArgument);
  EXPECT_TRUE(says("amplifier_max_a"));
}

TEST_F(PhantomDriverTest, ASimulatedSerialArmIsOfTheModelInItsName) {
  plugin::DriverSettings settings;
  settings.amplifier_max_a = 6.0;
  EXPECT_TRUE(sut->probe(teensy_at("sim:woody-2015-serial"), settings));
  EXPECT_EQ(refusal(teensy_at("sim:nobody-serial"), settings), Errc::InvalidArgument);
}

TEST_F(PhantomDriverTest, LeavesOtherDevicesToOtherDrivers) {
  for (const auto& change : std::vector<void (*)(bus::BusDeviceInfo&)>{
           [](bus::BusDeviceInfo& info) { info.vendor_id = 0x1235; },
           [](bus::BusDeviceInfo& info) { info.product_id = 0x0486; },
           [](bus::BusDeviceInfo& info) { info.kind = bus::BusKind::Usb; },
           [](bus::BusDeviceInfo& info) { info.input_report_bytes = 64; },
           [](bus::BusDeviceInfo& info) { info.output_report_bytes = 8; }}) {
    bus::BusDeviceInfo info = mbed_at("hid:123");
    change(info);
    EXPECT_EQ(refusal(info, named_vintage()), Errc::NotMine);
    EXPECT_EQ(refusal(info, {}), Errc::NotMine);
  }
}

TEST_F(PhantomDriverTest, RefusesASharedIdThatNobodyNamed) {
  plugin::DriverSettings settings = named_vintage();
  settings.is_named_by_person = false;
  EXPECT_EQ(refusal(mbed_at("hid:123"), settings), Errc::Permission);
  EXPECT_TRUE(says("hid:123"));
  EXPECT_TRUE(says("serial number or port"));
  EXPECT_EQ(refusal(mbed_at("hid:sim:phantom-vintage"), settings), Errc::Permission);
}

TEST_F(PhantomDriverTest, WantsTheFullScaleOfTheAmplifier) {
  plugin::DriverSettings settings = named_vintage();
  settings.amplifier_max_a.reset();
  EXPECT_EQ(refusal(mbed_at("hid:123"), settings), Errc::InvalidArgument);
  EXPECT_TRUE(says("amplifier_max_a"));
  EXPECT_TRUE(says("3 A or 6 A"));
  for (const double bad : {0.0, -3.0, 32.768, 50.0, std::nan(""), HUGE_VAL}) {
    settings.amplifier_max_a = bad;
    EXPECT_EQ(refusal(mbed_at("hid:123"), settings), Errc::InvalidArgument) << bad;
    EXPECT_TRUE(says("32.767 A")) << bad;
  }
  settings.amplifier_max_a = wire::kLargestCurrentA;
  EXPECT_TRUE(sut->probe(mbed_at("hid:123"), settings));
}

TEST_F(PhantomDriverTest, WantsAKnownModel) {
  plugin::DriverSettings settings = named_vintage();
  for (const char* bad : {"", "phantom", "Phantom-Vintage"}) {
    settings.model = bad;
    EXPECT_EQ(refusal(mbed_at("hid:123"), settings), Errc::InvalidArgument);
    EXPECT_TRUE(says("phantom-vintage, woody-2015, premium-1.5, aluhaptics-2, polhem-1"));
  }
}

TEST_F(PhantomDriverTest, ASimulatedDeviceIsOfTheModelInItsAddress) {
  plugin::DriverSettings settings;
  settings.amplifier_max_a = 6.0;
  OneDeviceBus buses;
  const auto device = sut->open(buses, mbed_at("sim:woody-2015"), settings);
  ASSERT_TRUE(device);
  EXPECT_EQ((*device)->capabilities().model, "woody-2015");
  EXPECT_EQ(refusal(mbed_at("sim:other"), settings), Errc::InvalidArgument);
  settings.model = "phantom-vintage";
  const auto other = sut->open(buses, mbed_at("sim:other"), settings);
  ASSERT_TRUE(other);
  EXPECT_EQ((*other)->capabilities().model, "phantom-vintage");
}

TEST_F(PhantomDriverTest, OpensADeviceThatHasSentNothing) {
  OneDeviceBus buses;
  const auto device = sut->open(buses, mbed_at("hid:123"), named_vintage());
  ASSERT_TRUE(device);
  EXPECT_EQ(buses.opened, std::vector<std::string>{"hid:123"});
  EXPECT_TRUE(buses.script.submitted.empty());
  EXPECT_EQ((*device)->capabilities().peak_current_a, (std::array{3.0, 3.0, 3.0}));
}

TEST_F(PhantomDriverTest, PassesOnWhyTheBusDoesNotOpen) {
  OneDeviceBus buses;
  buses.is_busy = true;
  const auto device = sut->open(buses, mbed_at("hid:123"), named_vintage());
  ASSERT_FALSE(device);
  EXPECT_EQ(device.error(), (Error{Errc::Busy, "phantom: open elsewhere"}));
}

}  // namespace
}  // namespace thimble::phantom
