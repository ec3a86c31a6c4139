#include "drivers/spacemouse/spacemouse_driver.hpp"

#include <gtest/gtest.h>

#include <set>
#include <utility>

#include "drivers/spacemouse/find_model.hpp"

namespace thimble::spacemouse {
namespace {

class NoBus final : public bus::BusEnumerator {
 public:
  std::vector<bus::BusDeviceInfo> list() override { return {}; }
  std::optional<bus::BusEvent> poll_event() override { return std::nullopt; }
  Result<std::unique_ptr<bus::HidDevice>> open_hid(const bus::DeviceAddress&) override {
    return fail(Errc::Busy, "open elsewhere");
  }
};

bus::BusDeviceInfo compact() {
  bus::BusDeviceInfo info;
  info.address = {"hid:port-1-2"};
  info.kind = bus::BusKind::Hid;
  info.vendor_id = 0x256f;
  info.product_id = 0xc635;
  info.input_report_bytes = 13;
  info.has_report_ids = true;
  return info;
}

TEST(SpaceMouseDriver, KnowsEveryPuckOfTheTableUnnamedAndNothingElse) {
  const auto sut = make_spacemouse_driver();
  std::set<std::pair<int, int>> seen;
  for (const SpaceMouseModel& model : kSpaceMouseModels) {
    EXPECT_TRUE(seen.insert({model.vendor_id, model.product_id}).second) << model.name;
    bus::BusDeviceInfo info = compact();
    info.vendor_id = model.vendor_id;
    info.product_id = model.product_id;
    EXPECT_TRUE(sut->probe(info, {})) << model.name;
  }
  EXPECT_EQ(seen.size(), 22U);
  for (const int product : {0xc62c, 0xc641, 0xc650, 0xc651, 0xc654, 0xc658, 0xc664, 0xc668}) {
    bus::BusDeviceInfo info = compact();
    info.product_id = static_cast<std::uint16_t>(product);
    EXPECT_EQ(sut->probe(info, {}).error().code, Errc::NotMine) << product;
  }
}

TEST(SpaceMouseDriver, RefusesAPuckWhereTheConfigurationNamesAnotherModel) {
  const auto sut = make_spacemouse_driver();
  plugin::DriverSettings settings;
  for (const char* good : {"", "spacemouse", "spacemouse-compact"}) {
    settings.model = good;
    EXPECT_TRUE(sut->probe(compact(), settings)) << good;
  }
  for (const char* other : {"phantom-vintage", "spacenavigator"}) {
    settings.model = other;
    const Result<void> refused = sut->probe(compact(), settings);
    ASSERT_FALSE(refused) << other;
    EXPECT_EQ(refused.error().code, Errc::InvalidArgument);
    EXPECT_NE(refused.error().message.find("'spacemouse-compact'"), std::string::npos);
    EXPECT_NE(refused.error().message.find(other), std::string::npos);
  }
}

TEST(SpaceMouseDriver, LeavesOtherFacesOfAReceiverAlone) {
  const auto sut = make_spacemouse_driver();
  bus::BusDeviceInfo keyboard = compact();
  keyboard.has_report_ids = false;
  EXPECT_EQ(sut->probe(keyboard, {}).error().code, Errc::NotMine);
  bus::BusDeviceInfo light = compact();
  light.input_report_bytes = 2;
  EXPECT_EQ(sut->probe(light, {}).error().code, Errc::NotMine);
  bus::BusDeviceInfo bare = compact();
  bare.kind = bus::BusKind::Usb;
  EXPECT_EQ(sut->probe(bare, {}).error().code, Errc::NotMine);
}

TEST(SpaceMouseDriver, SaysWhatItNeedsAndWhatTheBusSays) {
  const auto sut = make_spacemouse_driver();
  NoBus buses;
  EXPECT_EQ(sut->open(buses, compact(), {}).error().code, Errc::InvalidArgument);
  struct StoppedClock final : Clock {
    [[nodiscard]] MonotonicTime now() const noexcept override { return {}; }
    Duration sleep_until(MonotonicTime) noexcept override { return {}; }
  } clock;
  plugin::DriverSettings settings;
  settings.clock = &clock;
  EXPECT_EQ(sut->open(buses, compact(), settings).error().code, Errc::Busy);
}

}  // namespace
}  // namespace thimble::spacemouse
