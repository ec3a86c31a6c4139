#include "drivers/falcon/falcon_driver.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "drivers/falcon/falcon_match.hpp"
#include "drivers/falcon/find_model.hpp"
#include "drivers/falcon/firmware_image.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/falcon/scripted_usb.hpp"

namespace thimble::falcon {
namespace {

// A bus with one device, or with none that opens.
class OneDeviceBus final : public bus::BusEnumerator {
 public:
  std::vector<bus::BusDeviceInfo> list() override { return {}; }
  std::optional<bus::BusEvent> poll_event() override { return std::nullopt; }
  Result<std::unique_ptr<bus::HidDevice>> open_hid(const bus::DeviceAddress&) override {
    return fail(Errc::Unsupported, "no HID here");
  }
  Result<std::unique_ptr<bus::UsbDevice>> open_usb(const bus::DeviceAddress& address,
                                                   const bus::UsbClaim& claimed) override {
    opened.push_back(address.text);
    claim = claimed;
    if (is_busy) return fail(Errc::Busy, "open elsewhere");
    return std::make_unique<test::ScriptedUsb>(script);
  }
  test::UsbScript script;
  std::vector<std::string> opened;
  bus::UsbClaim claim;
  bool is_busy{false};
};

bus::BusDeviceInfo falcon_at(std::string address) {
  bus::BusDeviceInfo info;
  info.address = {std::move(address)};
  info.kind = bus::BusKind::Usb;
  info.vendor_id = 0x0403;
  info.product_id = 0xcb48;
  info.endpoints = {{0, 0x81, bus::UsbTransferKind::Bulk, 64, 0},
                    {0, 0x02, bus::UsbTransferKind::Bulk, 64, 0}};
  return info;
}

class FalconDriverTest : public testing::Test {
 protected:
  Errc refusal(const bus::BusDeviceInfo& info, const plugin::DriverSettings& settings) {
    const auto probed = sut->probe(info, settings);
    if (probed) return Errc::System;  // never given by probe()
    message = probed.error().message;
    OneDeviceBus buses;
    EXPECT_FALSE(sut->open(buses, info, settings));
    EXPECT_TRUE(buses.opened.empty()) << "touched a device that it refuses";
    return probed.error().code;
  }
  bool says(std::string_view word) const { return message.find(word) != std::string::npos; }
  std::unique_ptr<plugin::Driver> sut = make_falcon_driver();
  std::string message;
};

TEST_F(FalconDriverTest, TakesAFalconThatNobodyNamed) {
  EXPECT_EQ(sut->name(), "falcon");
  EXPECT_TRUE(sut->probe(falcon_at("usb:1-4"), {}));
}

TEST_F(FalconDriverTest, LeavesOtherDevicesToOtherDrivers) {
  for (const auto& change : std::vector<void (*)(bus::BusDeviceInfo&)>{
           [](bus::BusDeviceInfo& info) { info.vendor_id = 0x0404; },
           [](bus::BusDeviceInfo& info) { info.product_id = 0x6001; },
           [](bus::BusDeviceInfo& info) { info.kind = bus::BusKind::Hid; },
           [](bus::BusDeviceInfo& info) { info.endpoints.pop_back(); },
           [](bus::BusDeviceInfo& info) { info.endpoints.clear(); },
           [](bus::BusDeviceInfo& info) { info.endpoints[0].max_packet_bytes = 512; },
           [](bus::BusDeviceInfo& info) { info.endpoints[1].interface_number = 1; },
           [](bus::BusDeviceInfo& info) {
             info.endpoints[1].kind = bus::UsbTransferKind::Interrupt;
           }}) {
    bus::BusDeviceInfo info = falcon_at("usb:1-4");
    change(info);
    EXPECT_EQ(refusal(info, {}), Errc::NotMine);
  }
}

TEST_F(FalconDriverTest, KnowsOneModel) {
  plugin::DriverSettings settings;
  settings.model = "falcon";
  EXPECT_TRUE(sut->probe(falcon_at("usb:1-4"), settings));
  settings.model = "omega";
  EXPECT_EQ(refusal(falcon_at("usb:1-4"), settings), Errc::InvalidArgument);
  EXPECT_TRUE(says("'omega'"));
}

TEST_F(FalconDriverTest, AMeasuredScaleReplacesTheOneOfTheTable) {
  const FalconModel& model = *find_model("falcon");
  plugin::DriverSettings settings;
  EXPECT_EQ(match(falcon_at("usb:1-4"), settings)->newton_per_count, model.newton_per_count);
  settings.newton_per_count = 0.0025;
  EXPECT_EQ(match(falcon_at("usb:1-4"), settings)->newton_per_count, 0.0025);
}

// Half of what is advertised at the largest command is no Falcon.
TEST_F(FalconDriverTest, AScaleThatWouldMakeItTooStrongIsRefused) {
  plugin::DriverSettings settings;
  for (const double bad : {0.0, -0.01, 0.0009, 1.1, std::nan(""), HUGE_VAL}) {
    settings.newton_per_count = bad;
    EXPECT_EQ(refusal(falcon_at("usb:1-4"), settings), Errc::InvalidArgument) << bad;
    EXPECT_TRUE(says("newton_per_count")) << bad;
  }
}

TEST_F(FalconDriverTest, OpensADeviceThatHasSentNothing) {
  OneDeviceBus buses;
  const auto device = sut->open(buses, falcon_at("usb:1-4"), {});
  ASSERT_TRUE(device);
  EXPECT_EQ(buses.opened, std::vector<std::string>{"usb:1-4"});
  EXPECT_TRUE(buses.script.submitted.empty());
  EXPECT_TRUE(buses.script.requests.empty());
  EXPECT_EQ((*device)->capabilities().model, "falcon");
}

TEST_F(FalconDriverTest, ClaimsTheStreamInAndTheNewestOut) {
  OneDeviceBus buses;
  ASSERT_TRUE(sut->open(buses, falcon_at("usb:1-4"), {}));
  EXPECT_EQ(buses.claim.interface_number, 0);
  ASSERT_EQ(buses.claim.pipes.size(), 2U);
  EXPECT_EQ(buses.claim.pipes[0].endpoint, 0x81);
  EXPECT_EQ(buses.claim.pipes[0].delivery, bus::UsbDelivery::Every);
  EXPECT_EQ(buses.claim.pipes[1].endpoint, 0x02);
}

TEST_F(FalconDriverTest, AFirmwareThatCannotBeReadLeavesTheDeviceUntouched) {
  OneDeviceBus buses;
  plugin::DriverSettings settings;
  settings.firmware = "/nowhere/falcon.bin";
  EXPECT_TRUE(sut->probe(falcon_at("usb:1-4"), settings)) << "a probe reads no files";
  const auto device = sut->open(buses, falcon_at("usb:1-4"), settings);
  ASSERT_FALSE(device);
  EXPECT_EQ(device.error().code, Errc::NotFound);
  EXPECT_TRUE(buses.opened.empty());
}

TEST_F(FalconDriverTest, AFirmwareThatWasMeantIsTaken) {
  const testing_support::TemporaryFolder folder;
  const std::string image("\xaa\x08\0\0\1\2\3", 7);
  const std::string path = folder.write("falcon.bin", image);
  plugin::DriverSettings settings;
  settings.firmware = path;
  settings.firmware_sha256 =
      sha256_of({reinterpret_cast<const std::uint8_t*>(image.data()), image.size()});
  OneDeviceBus buses;
  EXPECT_TRUE(sut->open(buses, falcon_at("usb:1-4"), settings));
}

TEST_F(FalconDriverTest, ADeviceThatIsHeldElsewhereSaysSo) {
  OneDeviceBus buses;
  buses.is_busy = true;
  const auto device = sut->open(buses, falcon_at("usb:1-4"), {});
  ASSERT_FALSE(device);
  EXPECT_EQ(device.error().code, Errc::Busy);
  EXPECT_EQ(device.error().message, "falcon: open elsewhere");
}

}  // namespace
}  // namespace thimble::falcon
