#include "hal/bus/bus_enumerator.hpp"

#include <gtest/gtest.h>

namespace thimble::bus {
namespace {

// A bus of HID devices alone, which says nothing of USB.
class HidOnlyBus final : public BusEnumerator {
 public:
  std::vector<BusDeviceInfo> list() override { return {}; }
  std::optional<BusEvent> poll_event() override { return std::nullopt; }
  Result<std::unique_ptr<HidDevice>> open_hid(const DeviceAddress& address) override {
    return fail(Errc::NotFound, address.text);
  }
};

TEST(BusEnumerator, ABusWithoutUsbDevicesSaysSoAndNamesTheDevice) {
  HidOnlyBus sut;
  const auto device = sut.open_usb({"usb:1-4"}, {});
  ASSERT_FALSE(device.has_value());
  EXPECT_EQ(device.error().code, Errc::Unsupported);
  EXPECT_NE(device.error().message.find("usb:1-4"), std::string::npos);
}

}  // namespace
}  // namespace thimble::bus
