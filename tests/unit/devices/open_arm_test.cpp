#include "daemon/devices/open_arm.hpp"

#include <gtest/gtest.h>

namespace thimble::devices {
namespace {

class TwoDevices final : public bus::BusEnumerator {
 public:
  std::vector<bus::BusDeviceInfo> list() override {
    bus::BusDeviceInfo a;
    a.address.text = "hid:A";
    bus::BusDeviceInfo b;
    b.address.text = "hid:B";
    b.kind = bus::BusKind::Hid;
    b.port = "1-4:1.2";
    return {a, b};
  }
  std::optional<bus::BusEvent> poll_event() override { return std::nullopt; }
  Result<std::unique_ptr<bus::HidDevice>> open_hid(const bus::DeviceAddress&) override {
    return fail(Errc::Busy, "opened already");
  }
};

class PickyDriver final : public plugin::Driver {
 public:
  PickyDriver(std::string name, std::string address, Errc refusal, std::string why = "refused")
      : name_(std::move(name)), address_(std::move(address)), refusal_{refusal, std::move(why)} {}
  [[nodiscard]] std::string_view name() const noexcept override { return name_; }
  [[nodiscard]] std::vector<std::string> models() const override { return {}; }
  [[nodiscard]] Result<void> check_files(
      const plugin::DriverSettings& /*it reads none*/) const override {
    return {};
  }
  [[nodiscard]] Result<void> probe(const bus::BusDeviceInfo& info,
                                   const plugin::DriverSettings&) const override {
    if (info.address.text == address_) return {};
    return tl::unexpected(refusal_);
  }
  [[nodiscard]] Result<std::unique_ptr<HapticDevice>> open(
      bus::BusEnumerator& buses, const bus::BusDeviceInfo& info,
      const plugin::DriverSettings&) const override {
    return tl::unexpected(buses.open_hid(info.address).error());
  }

 private:
  std::string name_;
  std::string address_;
  Error refusal_;
};

std::string message_for(const char* address, const plugin::DriverRegistry& drivers) {
  TwoDevices buses;
  return open_arm(buses, drivers, {address}, {}).error().message;
}

TEST(OpenArm, NamesWhatIsThereWhenTheAddressIsNot) {
  EXPECT_EQ(message_for("hid:C", {}), "no device at hid:C; there are: hid:A hid:B");
}

// A configuration may be older than the names of places that it has in it.
TEST(OpenArm, NamesWhatIsInThePortThatItIsAskedFor) {
  EXPECT_EQ(
      message_for("hid:1-4:1.2", {}),
      "no device at hid:1-4:1.2; what the kernel calls so today is: hid:B, which may be another "
      "device than the one that was meant; there are: hid:A hid:B");
  for (const char* other : {"usb:1-4:1.2", "hid:1-4", "hid:"}) {
    EXPECT_EQ(message_for(other, {}).find("calls so today"), std::string::npos) << other;
  }
}

TEST(OpenArm, SaysSoWhenNoDriverKnowsTheDevice) {
  plugin::DriverRegistry drivers;
  drivers.add(std::make_unique<PickyDriver>("first", "hid:B", Errc::NotMine, ""));
  EXPECT_EQ(message_for("hid:A", drivers), "no driver knows the device at hid:A");
}

TEST(OpenArm, SaysWhatEachDriverHasAgainstADeviceWithItsIds) {
  plugin::DriverRegistry drivers;
  drivers.add(std::make_unique<PickyDriver>("first", "hid:B", Errc::NotMine, "no reports"));
  drivers.add(std::make_unique<PickyDriver>("second", "hid:B", Errc::NotMine, ""));
  drivers.add(std::make_unique<PickyDriver>("third", "hid:B", Errc::NotMine, "too short"));
  EXPECT_EQ(message_for("hid:A", drivers),
            "no driver knows the device at hid:A: first: no reports; third: too short");
}

TEST(OpenArm, ADriverThatSaysNotMineLetsTheNextOneTry) {
  plugin::DriverRegistry drivers;
  drivers.add(std::make_unique<PickyDriver>("first", "hid:B", Errc::NotMine));
  drivers.add(std::make_unique<PickyDriver>("second", "hid:A", Errc::NotMine));
  EXPECT_EQ(message_for("hid:A", drivers), "hid:A: second: opened already");
}

TEST(OpenArm, AnyOtherRefusalStopsTheMatchingAndIsReported) {
  plugin::DriverRegistry drivers;
  drivers.add(std::make_unique<PickyDriver>("first", "hid:B", Errc::Permission));
  drivers.add(std::make_unique<PickyDriver>("second", "hid:A", Errc::NotMine));
  EXPECT_EQ(message_for("hid:A", drivers), "first: refused");
}

}  // namespace
}  // namespace thimble::devices
