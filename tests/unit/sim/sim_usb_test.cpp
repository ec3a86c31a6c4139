#include "sim/bus/sim_usb.hpp"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <memory>
#include <thread>
#include <vector>

#include "sim/bus/sim_enumerator.hpp"
#include "sim/bus/sim_usb_port.hpp"
#include "sim/time/virtual_clock.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/scripted_hid_model.hpp"
#include "tests/support/scripted_usb_model.hpp"

namespace thimble::sim {
namespace {

using bus::UsbDelivery;
using bus::UsbTransferKind;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using test::ScriptedUsbModel;
using test::UsbModelScript;
using Packet = UsbModelScript::Packet;

constexpr MonotonicTime at_us(std::int64_t us) { return {microseconds(us)}; }
constexpr std::uint8_t kBulkIn = ScriptedUsbModel::kBulkIn;
constexpr std::uint8_t kBulkOut = ScriptedUsbModel::kBulkOut;
constexpr std::uint8_t kInterruptIn = ScriptedUsbModel::kInterruptIn;
constexpr std::uint8_t kInterruptOut = ScriptedUsbModel::kInterruptOut;

bus::UsbClaim whole_claim() {
  bus::UsbClaim claim;
  claim.pipes.push_back({kBulkIn, UsbDelivery::Every});
  claim.pipes.push_back({kBulkOut, UsbDelivery::Newest});
  claim.pipes.push_back({kInterruptIn, UsbDelivery::Every});
  claim.pipes.push_back({kInterruptOut, UsbDelivery::Newest});
  return claim;
}

struct SimUsbTest : testing::Test {
  const bus::DeviceAddress address{"sim:a"};
  VirtualClock clock;
  SimEnumerator buses{clock};
  std::shared_ptr<UsbModelScript> script = std::make_shared<UsbModelScript>();

  SimUsbTest() {
    EXPECT_TRUE(buses.plug(address, std::make_unique<ScriptedUsbModel>(script)).has_value());
  }
  std::unique_ptr<bus::UsbDevice> open() { return buses.open_usb(address, whole_claim()).value(); }
  static std::vector<MonotonicTime> arrivals(bus::UsbDevice& sut, std::uint8_t endpoint) {
    std::vector<MonotonicTime> times;
    bus::UsbPacket packet;
    while (sut.read(endpoint, packet) == IoStatus::Ok) times.push_back(packet.arrived_at);
    return times;
  }
};

TEST_F(SimUsbTest, TheModelAdvancesEightTimesAFrameWhetherOpenedOrNot) {
  clock.run_for(milliseconds(3));
  EXPECT_EQ(script->advances, 24);
}

TEST_F(SimUsbTest, ABulkPacketReachesTheDeviceInTheNextRoundNotTheNextFrame) {
  const auto sut = open();
  clock.sleep_until(at_us(2000));
  sut->submit(kBulkOut, Packet{1});
  clock.sleep_until(at_us(2124));
  EXPECT_TRUE(script->received[kBulkOut].empty());
  clock.sleep_until(at_us(2125));
  EXPECT_EQ(script->received_at[kBulkOut], std::vector<MonotonicTime>{at_us(2125)});
}

TEST_F(SimUsbTest, AnAnswerWithinAFrameComesWithinIt) {
  const auto sut = open();
  clock.sleep_until(at_us(2000));
  sut->submit(kBulkOut, Packet{1});
  clock.sleep_until(at_us(2200));
  script->to_send[kBulkIn].push_back({2});
  clock.sleep_until(at_us(3000));
  EXPECT_EQ(arrivals(*sut, kBulkIn), std::vector<MonotonicTime>{at_us(2250)});
}

TEST_F(SimUsbTest, AnInterruptPipeMovesOnceWhenItsFrameEnds) {
  const auto sut = open();
  for (int i = 0; i < 3; ++i) script->to_send[kInterruptIn].push_back({1});
  clock.sleep_until(at_us(500));
  sut->submit(kInterruptOut, Packet{1});
  clock.sleep_until(at_us(3500));
  EXPECT_EQ(script->received_at[kInterruptOut], std::vector<MonotonicTime>{at_us(1000)});
  EXPECT_EQ(arrivals(*sut, kInterruptIn),
            (std::vector<MonotonicTime>{at_us(1000), at_us(2000), at_us(3000)}));
}

// 187 bytes of a round hold two packets of 64 bytes with 13 bytes about each.
TEST_F(SimUsbTest, FullPacketsFillAFrameWithSixteen) {
  const auto sut = open();
  for (int i = 0; i < 40; ++i) script->to_send[kBulkIn].push_back(Packet(64, 1));
  clock.sleep_until(at_us(125));
  EXPECT_EQ(arrivals(*sut, kBulkIn).size(), 2U);
  clock.sleep_until(at_us(1000));
  EXPECT_EQ(sut->counters(kBulkIn).packets_in, 16U);
}

// 13 + 1 bytes each, but the last needs room for 13 + 64 before it may begin.
TEST_F(SimUsbTest, SmallPacketsShareARound) {
  const auto sut = open();
  for (int i = 0; i < 40; ++i) script->to_send[kBulkIn].push_back({1});
  clock.sleep_until(at_us(125));
  EXPECT_EQ(arrivals(*sut, kBulkIn).size(), 8U);
}

TEST_F(SimUsbTest, WhatDoesNotFitARoundWaitsForTheNext) {
  const auto sut = open();
  for (int i = 0; i < 2; ++i) script->to_send[kBulkIn].push_back(Packet(64, 1));
  sut->submit(kBulkOut, Packet(64, 1));
  bus::UsbControlRequest request;
  request.length = 20;
  sut->start_control(request);  // 65 bytes, then 77 out: 45 of 187 are left
  clock.sleep_until(at_us(125));
  EXPECT_EQ(script->received[kBulkOut].size(), 1U);
  EXPECT_TRUE(arrivals(*sut, kBulkIn).empty());
  clock.sleep_until(at_us(250));
  EXPECT_EQ(arrivals(*sut, kBulkIn).size(), 2U);
}

TEST_F(SimUsbTest, NobodyAsksADeviceThatIsNotOpen) {
  script->to_send[kBulkIn].push_back({7});
  clock.run_for(milliseconds(3));
  const auto sut = open();
  clock.run_for(milliseconds(1));
  EXPECT_EQ(arrivals(*sut, kBulkIn).size(), 1U) << "it waited in the device";
}

TEST_F(SimUsbTest, OnlyClaimedPipesAreAsked) {
  script->to_send[kInterruptIn].push_back({7});
  bus::UsbClaim claim;
  claim.pipes.push_back({kBulkOut, UsbDelivery::Newest});
  const auto sut = buses.open_usb(address, claim).value();
  clock.run_for(milliseconds(3));
  EXPECT_EQ(script->to_send[kInterruptIn].size(), 1U);
}

TEST_F(SimUsbTest, PowerIsCutAtUnplugAndAtReplugAndTheOldHandleStaysDead) {
  const auto old_handle = open();
  ASSERT_TRUE(buses.unplug(address).has_value());
  clock.run_for(milliseconds(1));
  ASSERT_TRUE(buses.replug(address).has_value());
  clock.run_for(milliseconds(1));
  EXPECT_EQ(script->power_cycles, 2);
  const auto sut = open();
  EXPECT_EQ(sut->submit(kBulkOut, Packet{1}), IoStatus::Ok);
  EXPECT_EQ(old_handle->submit(kBulkOut, Packet{1}), IoStatus::Disconnected);
}

TEST_F(SimUsbTest, WithItsSupplyTheDeviceGoesOnThoughTheHandleIsDead) {
  const auto old_handle = open();
  ASSERT_TRUE(buses.unplug(address, Supply::Stays).has_value());
  clock.run_for(milliseconds(1));
  EXPECT_EQ(old_handle->submit(kBulkOut, Packet{1}), IoStatus::Disconnected);
  ASSERT_TRUE(buses.replug(address).has_value());
  clock.run_for(milliseconds(1));
  EXPECT_EQ(script->power_cycles, 0);
  EXPECT_EQ(open()->submit(kBulkOut, Packet{1}), IoStatus::Ok);
}

TEST_F(SimUsbTest, HidAndUsbDevicesHangOnOneBus) {
  const bus::DeviceAddress other{"sim:b"};
  auto hid = std::make_shared<test::HidModelScript>();
  ASSERT_TRUE(buses.plug(other, std::make_unique<test::ScriptedHidModel>(hid)).has_value());
  EXPECT_EQ(buses.list().size(), 2U);
  EXPECT_EQ(buses.open_usb(other, whole_claim()).error().code, Errc::InvalidArgument);
  EXPECT_EQ(buses.open_hid(address).error().code, Errc::InvalidArgument);
  EXPECT_TRUE(buses.open_hid(other).has_value());
  EXPECT_TRUE(buses.open_usb(address, whole_claim()).has_value());
}

TEST_F(SimUsbTest, PlugRefusesWhatCannotWork) {
  class HighSpeedModel final : public plugin::SimUsbModel {
   public:
    bus::BusDeviceInfo describe() const override {
      bus::BusDeviceInfo info;
      info.endpoints = {{0, 0x81, UsbTransferKind::Bulk, 512, 0}};
      return info;
    }
    void advance(MonotonicTime) noexcept override {}
    plugin::UsbAnswer control(const bus::UsbControlRequest&,
                              std::span<std::uint8_t>) noexcept override {
      return {};
    }
    plugin::UsbHandshake out_packet(std::uint8_t, std::span<const std::uint8_t>) noexcept override {
      return plugin::UsbHandshake::Nak;
    }
    plugin::UsbAnswer in_packet(std::uint8_t, std::span<std::uint8_t>) noexcept override {
      return {};
    }
    void power_cycle() noexcept override {}
    plugin::ArmBackend* arm_backend() noexcept override { return nullptr; }
  };
  const auto code = [&](const char* where, std::unique_ptr<plugin::SimUsbModel> model) {
    const Result<void> result = buses.plug({where}, std::move(model));
    return result.has_value() ? std::string("accepted")
                              : std::string(to_string(result.error().code));
  };
  EXPECT_EQ(code("sim:a", std::make_unique<ScriptedUsbModel>(script)), "busy");
  EXPECT_EQ(code("sim:b", nullptr), "invalid argument");
  EXPECT_EQ(code("sim:c", std::make_unique<HighSpeedModel>()), "invalid argument");
  EXPECT_EQ(buses.list().size(), 1U);
}

TEST_F(SimUsbTest, AnExchangeAllocatesNothing) {
  class EchoModel final : public plugin::SimUsbModel {
   public:
    bus::BusDeviceInfo describe() const override { return ScriptedUsbModel(nullptr).describe(); }
    void advance(MonotonicTime) noexcept override {}
    plugin::UsbAnswer control(const bus::UsbControlRequest&,
                              std::span<std::uint8_t>) noexcept override {
      return {plugin::UsbHandshake::Ack, 0};
    }
    plugin::UsbHandshake out_packet(std::uint8_t, std::span<const std::uint8_t>) noexcept override {
      has_answer_ = true;
      return plugin::UsbHandshake::Ack;
    }
    plugin::UsbAnswer in_packet(std::uint8_t, std::span<std::uint8_t>) noexcept override {
      if (!has_answer_) return {};
      has_answer_ = false;
      return {plugin::UsbHandshake::Ack, 18};
    }
    void power_cycle() noexcept override {}
    plugin::ArmBackend* arm_backend() noexcept override { return nullptr; }

   private:
    bool has_answer_{false};
  };
  ASSERT_TRUE(buses.plug({"sim:echo"}, std::make_unique<EchoModel>()).has_value());
  const auto sut = buses.open_usb({"sim:echo"}, whole_claim()).value();
  const std::array<std::uint8_t, 16> command{};
  bus::UsbPacket packet;
  bus::UsbControlReply reply;

  const std::uint64_t before = test::allocation_count();
  for (int tick = 0; tick < 1000; ++tick) {
    clock.run_for(milliseconds(1));
    while (sut->read(kBulkIn, packet) == IoStatus::Ok) {
    }
    sut->submit(kBulkOut, command);
    sut->read_control(reply);
    sut->start_control({});
  }

  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_EQ(sut->counters(kBulkOut).packets_out, 999U);
  EXPECT_EQ(sut->counters(kBulkIn).packets_in, 999U);
  EXPECT_EQ(sut->counters(0).packets_out, 999U);
}

// One thread runs the bus while another opens, closes and pulls the cable: nothing is touched
// after it is gone (ThreadSanitizer and AddressSanitizer watch).
TEST_F(SimUsbTest, OpeningAndClosingWhileAnotherThreadRunsTheBusIsSafe) {
  std::atomic<bool> is_over{false};
  std::thread servo([&] {
    while (!is_over.load()) clock.run_for(milliseconds(1));
  });
  for (int i = 0; i < 2000; ++i) {
    auto sut = buses.open_usb(address, whole_claim());
    ASSERT_TRUE(sut.has_value());
    sut.value()->submit(kBulkOut, Packet{1});
    sut.value()->start_control({});
    if (i % 3 == 0) {
      ASSERT_TRUE(buses.unplug(address).has_value());
      EXPECT_EQ(sut.value()->submit(kBulkOut, Packet{1}), IoStatus::Disconnected);
      ASSERT_TRUE(buses.replug(address).has_value());
    }
  }
  is_over.store(true);
  servo.join();
}

}  // namespace
}  // namespace thimble::sim
