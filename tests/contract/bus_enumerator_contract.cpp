#include "tests/contract/bus_enumerator_contract.hpp"

#include <algorithm>
#include <optional>

namespace thimble::test {
namespace {

bool lists(BusRig& rig) {
  const auto devices = rig.buses().list();
  return std::any_of(devices.begin(), devices.end(),
                     [&](const bus::BusDeviceInfo& info) { return info.address == rig.address(); });
}

// As the bus says it.
bus::DeviceAddress listed(BusRig& rig) {
  for (const bus::BusDeviceInfo& info : rig.buses().list()) {
    if (info.address == rig.address()) return info.address;
  }
  ADD_FAILURE() << "it is not listed";
  return {};
}

// The next event of the device. On a real bus it may have another face (a HID device on USB is a
// USB device, too), of which as much is told.
std::optional<bus::BusEvent> next_told(BusRig& rig) {
  while (auto event = rig.buses().poll_event()) {
    if (event->device.address == rig.address()) return event;
  }
  return std::nullopt;
}

}  // namespace

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(BusEnumeratorContract);

BusEnumeratorContract::BusEnumeratorContract() {
  rig->settle();
  while (rig->buses().poll_event().has_value()) {
  }
}

TEST_P(BusEnumeratorContract, ListsThePresentDevice) {
  EXPECT_TRUE(lists(*rig));
  EXPECT_FALSE(rig->buses().poll_event().has_value());
}

TEST_P(BusEnumeratorContract, AnUnknownAddressIsNotFoundAndNamed) {
  const auto device = rig->buses().open_hid({"sim:nowhere"});
  ASSERT_FALSE(device.has_value());
  EXPECT_EQ(device.error().code, Errc::NotFound);
  EXPECT_NE(device.error().message.find("sim:nowhere"), std::string::npos);
}

TEST_P(BusEnumeratorContract, OnlyOneMayHoldADevice) {
  auto first = rig->buses().open_hid(rig->address());
  ASSERT_TRUE(first.has_value());

  const auto second = rig->buses().open_hid(rig->address());
  ASSERT_FALSE(second.has_value());
  EXPECT_EQ(second.error().code, Errc::Busy);

  first.value().reset();
  EXPECT_TRUE(rig->buses().open_hid(rig->address()).has_value());
}

TEST_P(BusEnumeratorContract, OpeningAndClosingIsNoArrival) {
  { const auto device = rig->buses().open_hid(rig->address()); }
  rig->settle();
  EXPECT_FALSE(rig->buses().poll_event().has_value());
  EXPECT_TRUE(lists(*rig));
}

TEST_P(BusEnumeratorContract, ADepartureIsToldOnceAndTheDeviceIsGone) {
  rig->unplug();
  rig->settle();

  const auto event = next_told(*rig);
  ASSERT_TRUE(event.has_value());
  EXPECT_EQ(event->kind, bus::BusEvent::Kind::Left);
  EXPECT_FALSE(next_told(*rig).has_value());
  EXPECT_FALSE(lists(*rig));
  const auto device = rig->buses().open_hid(rig->address());
  ASSERT_FALSE(device.has_value());
  EXPECT_EQ(device.error().code, Errc::NotFound);
}

TEST_P(BusEnumeratorContract, AReturnIsToldInOrderWithTheSameDescription) {
  const auto before = rig->buses().list();
  rig->unplug();
  rig->settle();
  rig->replug();
  rig->settle();

  const auto left = next_told(*rig);
  ASSERT_TRUE(left.has_value());
  EXPECT_EQ(left->kind, bus::BusEvent::Kind::Left);
  const auto event = next_told(*rig);
  ASSERT_TRUE(event.has_value());
  EXPECT_EQ(event->kind, bus::BusEvent::Kind::Arrived);
  EXPECT_EQ(rig->buses().list(), before);
}

// It was listed, matched and chosen; what returned in its place may be anything.
TEST_P(BusEnumeratorContract, AnAddressThatWasListedOpensNothingThatWasPluggedInSince) {
  const bus::DeviceAddress before = listed(*rig);
  rig->unplug();
  rig->settle();
  rig->replug();
  rig->settle();
  const bus::DeviceAddress now = listed(*rig);
  EXPECT_EQ(now, before) << "the same name";

  const auto refused = rig->buses().open_hid(before);
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, Errc::NotFound);
  EXPECT_NE(refused.error().message.find(before.text), std::string::npos);
  EXPECT_TRUE(rig->buses().open_hid(now).has_value());
}

TEST_P(BusEnumeratorContract, AReturnedDeviceOpensAnewWhileTheOldHandleStaysDead) {
  const auto old_handle = rig->buses().open_hid(rig->address()).value();
  rig->unplug();
  rig->settle();
  rig->replug();
  rig->settle();

  const auto new_handle = rig->buses().open_hid(rig->address());
  ASSERT_TRUE(new_handle.has_value());
  bus::HidReport report;
  EXPECT_TRUE(
      rig->comes_true([&] { return old_handle->read_newest(report) == IoStatus::Disconnected; }));
  EXPECT_NE(new_handle.value()->read_newest(report), IoStatus::Disconnected);
}

}  // namespace thimble::test
