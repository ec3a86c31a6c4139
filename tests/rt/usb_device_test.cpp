// linux::UsbDevice with its thread, over the libusb of tests/support/fake_libusb.cpp.
#include "hal/linux/usb_device.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "hal/linux/monotonic_clock.hpp"
#include "tests/rt/wait_until.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/fake_libusb.hpp"
#include "tests/support/scripted_usb_model.hpp"

namespace thimble::linux {
namespace {

using test::FakeUsbWire;
using test::ScriptedUsbModel;
using test::UsbModelScript;
using Packet = UsbModelScript::Packet;

constexpr std::uint8_t kIn = ScriptedUsbModel::kBulkIn;
constexpr std::uint8_t kOut = ScriptedUsbModel::kBulkOut;

struct UsbDeviceTest : testing::Test {
  MonotonicClock clock;
  std::shared_ptr<UsbModelScript> script = std::make_shared<UsbModelScript>();
  FakeUsbWire wire{std::make_unique<ScriptedUsbModel>(script)};

  Result<std::unique_ptr<UsbDevice>> open(std::uint8_t in_endpoint = kIn) {
    bus::UsbClaim claim;
    claim.pipes.push_back({in_endpoint, bus::UsbDelivery::Every});
    claim.pipes.push_back({kOut, bus::UsbDelivery::Newest});
    bus::BusDeviceInfo info = ScriptedUsbModel(script).describe();
    info.address = {"usb:1-4"};
    return UsbDevice::open(wire.open_node(), info, claim, clock, {.name = "usb:1-4"}, {});
  }
  // Frames until `is_done`, at most as many as a stalled machine may need.
  template <class Condition>
  bool run_until(const Condition& is_done) {
    return test::wait_until([&] {
      if (is_done()) return true;
      wire.run_frame();
      return false;
    });
  }
  ~UsbDeviceTest() override {
    EXPECT_EQ(wire.breaches(), std::vector<std::string>{});
    EXPECT_EQ(FakeUsbWire::alive(), 0);
  }
};

TEST_F(UsbDeviceTest, ASubmitWakesTheThreadAndTheAnswerArrives) {
  for (int i = 0; i < 5; ++i) script->to_send[kIn].push_back(Packet(16, 1));
  const auto sut = open().value();
  bus::UsbPacket packet;
  int read = 0;
  EXPECT_TRUE(run_until([&] { return (read += sut->read(kIn, packet) == IoStatus::Ok) == 5; }));
  for (std::uint64_t i = 1; i <= 20; ++i) {
    sut->submit(kOut, Packet(16, 2));
    EXPECT_TRUE(run_until([&] { return sut->counters(kOut).packets_out == i; })) << i;
  }
  sut->start_control({});
  bus::UsbControlReply reply;
  EXPECT_TRUE(run_until([&] { return sut->read_control(reply) == IoStatus::Ok; }));
}

TEST_F(UsbDeviceTest, IsSharedAsLongAsItIsOpen) {
  auto sut = open().value();
  const std::weak_ptr<const SharedDevice> shared = sut->shared();
  ASSERT_FALSE(shared.expired());
  const auto copy = share_again(*shared.lock());
  ASSERT_TRUE(copy.has_value()) << copy.error().message;
  EXPECT_NE(copy->node.get(), shared.lock()->node.get()) << "another number";
  EXPECT_EQ(copy->way, NodeWay::AsTheyAre);
  sut.reset();
  EXPECT_TRUE(shared.expired());
}

TEST_F(UsbDeviceTest, AnExchangeAllocatesNothingInTheThreadOfTheServo) {
  const auto sut = open().value();
  const Packet command(16, 2);
  bus::UsbPacket packet;
  bus::UsbControlReply reply;
  std::uint64_t allocated = 0;
  int read = 0;
  for (int tick = 0; tick < 500; ++tick) {
    script->to_send[kIn].push_back(Packet(16, 1));
    wire.run_frame();
    const std::uint64_t before = test::allocation_count();
    sut->submit(kOut, command);
    while (sut->read(kIn, packet) == IoStatus::Ok) ++read;
    sut->start_control({});
    sut->read_control(reply);
    allocated += test::allocation_count() - before;
  }
  EXPECT_EQ(allocated, 0U);
  // A reader whom the machine kept from running for 64 frames loses some, which are counted.
  EXPECT_TRUE(run_until([&] {
    // All of it: two may come with each frame, and what a full queue loses last nobody counts.
    while (sut->read(kIn, packet) == IoStatus::Ok) ++read;
    return static_cast<std::uint64_t>(read) + sut->counters(kIn).packets_skipped == 500;
  }));
  EXPECT_GT(read, 0);
}

TEST_F(UsbDeviceTest, AStallIsClearedByTheThread) {
  script->stalls_to_come.insert(kIn);
  script->to_send[kIn].push_back(Packet(16, 1));
  const auto sut = open().value();
  bus::UsbPacket packet;
  EXPECT_TRUE(run_until([&] { return sut->read(kIn, packet) == IoStatus::Ok; }));
  EXPECT_EQ(wire.halts_cleared(), 1);
}

TEST_F(UsbDeviceTest, AnUnplugShowsInBandAndClosingJoins) {
  const auto sut = open().value();
  EXPECT_TRUE(run_until([&] { return wire.pending() == 2; }));
  wire.unplug();
  bus::UsbPacket packet;
  EXPECT_TRUE(run_until([&] { return sut->read(kIn, packet) == IoStatus::Disconnected; }));
}

TEST_F(UsbDeviceTest, OpeningAndClosingInAHurryLeaksNothing) {
  for (int i = 0; i < 50; ++i) {
    const auto sut = open().value();
    sut->submit(kOut, Packet(16, 1));
    if (i % 2 == 0) wire.run_frame();
  }
  EXPECT_EQ(FakeUsbWire::alive(), 0);
}

TEST_F(UsbDeviceTest, TheNewestThatWasSubmittedStillReachesTheDeviceWhenItIsClosed) {
  wire.run_frames_by_events();
  for (std::uint8_t i = 0; i < 100; ++i) {
    auto sut = open().value();
    sut->submit(kOut, Packet(16, 200));
    sut->submit(kOut, Packet(16, i));
    sut.reset();
    ASSERT_FALSE(script->received[kOut].empty());
    ASSERT_EQ(script->received[kOut].back(), Packet(16, i));
  }
}

// The device takes nothing, or refuses: closing does not wait for ever, and is silent afterwards.
TEST_F(UsbDeviceTest, ClosingDoesNotWaitForADeviceThatTakesNothing) {
  wire.run_frames_by_events();
  script->deaf.insert(kOut);
  auto sut = open().value();
  sut->submit(kOut, Packet(16, 1));
  sut.reset();
  script->deaf.clear();
  wire.run_frame();
  EXPECT_TRUE(script->received[kOut].empty());
}

TEST_F(UsbDeviceTest, AKernelDriverIsOffWhileItIsOpen) {
  wire.bind_kernel_driver();
  auto sut = open();
  ASSERT_TRUE(sut.has_value()) << sut.error().message;
  EXPECT_FALSE(wire.is_kernel_driver_bound());
  sut->reset();
  EXPECT_TRUE(wire.is_kernel_driver_bound());
}

TEST_F(UsbDeviceTest, ARefusalNamesTheDevice) {
  const auto sut = open().value();
  const auto second = open();
  ASSERT_FALSE(second.has_value());
  EXPECT_EQ(second.error().code, Errc::Busy);
  EXPECT_NE(second.error().message.find("usb:1-4"), std::string::npos);
  const auto missing = open(0x87);
  ASSERT_FALSE(missing.has_value());
  EXPECT_EQ(missing.error().code, Errc::InvalidArgument);
}

}  // namespace
}  // namespace thimble::linux
