#include "tests/contract/bus_enumerator_contract.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "tests/contract/usb_rig.hpp"
#include "tests/support/look_again.hpp"

namespace thimble::test {
namespace {

bool is_meant(const BusRig& rig, const bus::BusDeviceInfo& info) {
  return info.address == rig.address() && info.kind == rig.kind();
}

bool lists(BusRig& rig) {
  const auto devices = rig.buses().list();
  return std::any_of(devices.begin(), devices.end(),
                     [&](const bus::BusDeviceInfo& info) { return is_meant(rig, info); });
}

// As the bus says it.
bus::DeviceAddress listed(BusRig& rig) {
  for (const bus::BusDeviceInfo& info : rig.buses().list()) {
    if (is_meant(rig, info)) return info.address;
  }
  ADD_FAILURE() << "it is not listed";
  return {};
}

// The next event of the device. On a real bus it may have another face (a HID device on USB is a
// USB device, too), of which as much is told.
std::optional<bus::BusEvent> next_told(BusRig& rig) {
  while (auto event = rig.buses().poll_event()) {
    if (is_meant(rig, event->device)) return event;
  }
  return std::nullopt;
}

// A device that is open for as long as this is; of whatever kind, it tells by a read whether it is
// still there.
struct Opened {
  std::function<bool()> is_gone;
};

template <class Device, class Read>
Result<Opened> held(Result<std::unique_ptr<Device>> opened, Read read) {
  if (!opened.has_value()) return tl::unexpected(opened.error());
  const std::shared_ptr<Device> device = *std::move(opened);
  return Opened{[device, read] { return read(*device) == IoStatus::Disconnected; }};
}

Result<Opened> open_as(bus::BusKind kind, BusRig& rig, const bus::DeviceAddress& address) {
  if (kind == bus::BusKind::Usb) {
    bus::UsbClaim claim;
    claim.pipes.push_back({UsbRig::kBulkIn, bus::UsbDelivery::Every});
    return held(rig.buses().open_usb(address, claim), [](bus::UsbDevice& device) {
      bus::UsbPacket packet;
      return device.read(UsbRig::kBulkIn, packet);
    });
  }
  if (kind == bus::BusKind::Serial) {
    return held(rig.buses().open_serial(address, {}), [](bus::SerialPort& port) {
      bus::SerialChunk chunk;
      return port.read(chunk);
    });
  }
  return held(rig.buses().open_hid(address), [](bus::HidDevice& device) {
    bus::HidReport report;
    return device.read_newest(report);
  });
}

Result<Opened> open(BusRig& rig, const bus::DeviceAddress& address) {
  return open_as(rig.kind(), rig, address);
}

// Of one that nobody has.
Result<Opened> open_free(BusRig& rig, const bus::DeviceAddress& address) {
  return look_again({Errc::Busy}, [&] { return open(rig, address); });
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
  const auto device = open(*rig, {"sim:nowhere"});
  ASSERT_FALSE(device.has_value());
  EXPECT_EQ(device.error().code, Errc::NotFound);
  EXPECT_NE(device.error().message.find("sim:nowhere"), std::string::npos);
}

TEST_P(BusEnumeratorContract, OnlyOneMayHoldADevice) {
  auto first = open_free(*rig, rig->address());
  ASSERT_TRUE(first.has_value()) << first.error().message;

  const auto second = open(*rig, rig->address());
  ASSERT_FALSE(second.has_value());
  EXPECT_EQ(second.error().code, Errc::Busy);

  first.value() = {};
  EXPECT_TRUE(open_free(*rig, rig->address()).has_value());
}

TEST_P(BusEnumeratorContract, ADeviceOpensAsWhatItIsAndAsNothingElse) {
  using enum bus::BusKind;
  for (const bus::BusKind kind : {Hid, Usb, Serial}) {
    const auto device =
        kind == rig->kind() ? open_free(*rig, rig->address()) : open_as(kind, *rig, rig->address());
    EXPECT_EQ(device.has_value(), kind == rig->kind()) << bus::to_string(kind);
    if (device.has_value()) continue;
    EXPECT_TRUE(device.error().code == Errc::NotFound ||
                device.error().code == Errc::InvalidArgument)
        << device.error().message;
  }
}

TEST_P(BusEnumeratorContract, OpeningAndClosingIsNoArrival) {
  { ASSERT_TRUE(open_free(*rig, rig->address()).has_value()); }
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
  const auto device = open_free(*rig, rig->address());
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

  const auto refused = open(*rig, before);
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, Errc::NotFound);
  EXPECT_NE(refused.error().message.find(before.text), std::string::npos);
  EXPECT_TRUE(open_free(*rig, now).has_value());
}

TEST_P(BusEnumeratorContract, AReturnedDeviceOpensAnewWhileTheOldHandleStaysDead) {
  const Opened old_handle = open_free(*rig, rig->address()).value();
  rig->unplug();
  rig->settle();
  rig->replug();
  rig->settle();

  const auto new_handle = open_free(*rig, rig->address());
  ASSERT_TRUE(new_handle.has_value()) << new_handle.error().message;
  EXPECT_TRUE(rig->comes_true(old_handle.is_gone));
  EXPECT_FALSE(new_handle->is_gone());
}

}  // namespace thimble::test
