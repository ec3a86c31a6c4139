#include "sim/bus/sim_hid.hpp"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <memory>
#include <thread>
#include <vector>

#include "sim/bus/sim_enumerator.hpp"
#include "sim/time/virtual_clock.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/scripted_hid_model.hpp"

namespace thimble::sim {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using test::HidModelScript;
using test::ScriptedHidModel;

constexpr MonotonicTime at_us(std::int64_t us) { return {microseconds(us)}; }
using OutBytes = std::array<std::uint8_t, ScriptedHidModel::kOutputBytes>;

struct SimHidTest : testing::Test {
  const bus::DeviceAddress address{"sim:a"};
  VirtualClock clock;
  SimEnumerator buses{clock};
  std::shared_ptr<HidModelScript> script = std::make_shared<HidModelScript>();

  SimHidTest() {
    EXPECT_TRUE(buses.plug(address, std::make_unique<ScriptedHidModel>(script)).has_value());
  }
  std::unique_ptr<bus::HidDevice> open() { return buses.open_hid(address).value(); }
};

TEST_F(SimHidTest, FramesRunWhetherOpenedOrNot) {
  clock.run_for(microseconds(3500));
  EXPECT_EQ(script->advanced_to,
            (std::vector<MonotonicTime>{at_us(1000), at_us(2000), at_us(3000)}));
}

TEST_F(SimHidTest, AReportSubmittedInAFrameReachesTheDeviceAtTheNext) {
  const auto sut = open();
  clock.sleep_until(at_us(2000));  // frame 2 has begun when the sleeper wakes
  sut->submit(OutBytes{1});
  clock.sleep_until(at_us(2999));
  EXPECT_TRUE(script->received.empty());
  clock.sleep_until(at_us(3000));

  ASSERT_EQ(script->received.size(), 1U);
  EXPECT_EQ(script->received_at[0], at_us(3000));
}

TEST_F(SimHidTest, AnInputReportIsStampedWithItsFrame) {
  const auto sut = open();
  script->to_send.push_back({1, 2});
  clock.sleep_until(at_us(1700));
  bus::HidReport report;

  ASSERT_EQ(sut->read_newest(report), IoStatus::Ok);

  EXPECT_EQ(report.arrived_at, at_us(1000));
}

TEST_F(SimHidTest, ASecondSubmitBeforeTheFrameIsBackloggedAndWins) {
  const auto sut = open();
  EXPECT_EQ(sut->submit(OutBytes{1}), IoStatus::Ok);
  EXPECT_EQ(sut->submit(OutBytes{2}), IoStatus::Backlogged);
  clock.run_for(milliseconds(2));

  ASSERT_EQ(script->received.size(), 1U);
  EXPECT_EQ(script->received[0][0], 2);
  EXPECT_EQ(sut->counters().writes_superseded, 1U);
  EXPECT_EQ(sut->counters().reports_out, 1U);
  EXPECT_EQ(sut->submit(OutBytes{3}), IoStatus::Ok) << "the mailbox is free again";
}

TEST_F(SimHidTest, WhatTheDeviceSentBeforeTheOpenIsNotDelivered) {
  script->to_send.push_back({1});
  clock.run_for(milliseconds(1));
  const auto sut = open();
  bus::HidReport report;
  EXPECT_EQ(sut->read_newest(report), IoStatus::NoData);
  EXPECT_EQ(sut->counters().reports_in, 0U);
}

TEST_F(SimHidTest, AReportLeftInTheMailboxDiesWithTheDevice) {
  {
    const auto sut = open();
    sut->submit(OutBytes{1});
  }
  const auto next = open();
  clock.run_for(milliseconds(2));
  EXPECT_TRUE(script->received.empty());
}

TEST_F(SimHidTest, PowerIsCutAtUnplugAndAtReplug) {
  ASSERT_TRUE(buses.unplug(address).has_value());
  clock.run_for(milliseconds(3));
  EXPECT_EQ(script->power_cycles, 1);
  ASSERT_TRUE(buses.replug(address).has_value());
  clock.run_for(milliseconds(3));
  EXPECT_EQ(script->power_cycles, 2);
  EXPECT_EQ(script->advanced_to.size(), 6U) << "the mechanics go on without the bus";
}

TEST_F(SimHidTest, AReplugBetweenTwoFramesStillCutsThePower) {
  ASSERT_TRUE(buses.unplug(address).has_value());
  ASSERT_TRUE(buses.replug(address).has_value());
  clock.run_for(milliseconds(3));
  EXPECT_EQ(script->power_cycles, 1);
}

TEST_F(SimHidTest, ADeviceThatKeepsItsSupplyIsAsItWasWhenItIsBack) {
  ASSERT_TRUE(buses.unplug(address, Supply::Stays).has_value());
  clock.run_for(milliseconds(3));
  ASSERT_TRUE(buses.replug(address).has_value());
  clock.run_for(milliseconds(3));
  EXPECT_EQ(script->power_cycles, 0);
  EXPECT_EQ(script->advanced_to.size(), 6U) << "it went on without the bus";
  ASSERT_TRUE(buses.unplug(address, Supply::Stays).has_value());
  ASSERT_TRUE(buses.unplug(address).has_value()) << "after the cable the supply";
  EXPECT_FALSE(buses.unplug(address).has_value());
  clock.run_for(milliseconds(1));
  EXPECT_EQ(script->power_cycles, 1);
  ASSERT_TRUE(buses.replug(address).has_value());
  clock.run_for(milliseconds(1));
  EXPECT_EQ(script->power_cycles, 2);
}

TEST_F(SimHidTest, EachDeviceRunsAtItsOwnFramePeriod) {
  const bus::DeviceAddress other{"sim:b"};
  auto other_script = std::make_shared<HidModelScript>();
  ASSERT_TRUE(buses.plug(other, std::make_unique<ScriptedHidModel>(other_script, microseconds(250)))
                  .has_value());
  clock.run_for(milliseconds(4));
  EXPECT_EQ(script->advanced_to.size(), 4U);
  EXPECT_EQ(other_script->advanced_to.size(), 16U);
}

TEST_F(SimHidTest, AFrameAllocatesNothing) {
  class SilentModel final : public plugin::SimHidModel {
   public:
    bus::BusDeviceInfo describe() const override {
      bus::BusDeviceInfo info;
      info.output_report_bytes = 8;
      return info;
    }
    Duration frame_period() const noexcept override { return milliseconds(1); }
    void advance(MonotonicTime) noexcept override {}
    void out_report(std::span<const std::uint8_t>) noexcept override {}
    std::size_t in_report(std::span<std::uint8_t> out) noexcept override { return out.size() - 1; }
    void power_cycle() noexcept override {}
    plugin::ArmBackend* arm_backend() noexcept override { return nullptr; }
  };
  ASSERT_TRUE(buses.plug({"sim:silent"}, std::make_unique<SilentModel>()).has_value());
  const auto sut = buses.open_hid({"sim:silent"}).value();
  script->advanced_to.reserve(2000);
  bus::HidReport report;

  const std::uint64_t before = test::allocation_count();
  for (int tick = 0; tick < 1000; ++tick) {
    clock.run_for(milliseconds(1));
    sut->read_newest(report);
    sut->submit(OutBytes{});
  }

  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_EQ(sut->counters().reports_in, 1000U);
  EXPECT_EQ(sut->counters().reports_out, 999U);
}

// One thread runs the frames while another opens, closes and pulls the cable: nothing is
// touched after it is gone (ThreadSanitizer and AddressSanitizer watch).
TEST_F(SimHidTest, OpeningAndClosingWhileAnotherThreadRunsTheFramesIsSafe) {
  std::atomic<bool> is_over{false};
  std::thread servo([&] {
    while (!is_over.load()) {
      clock.run_for(milliseconds(1));
      script->advanced_to.resize(1);
    }
  });
  for (int i = 0; i < 2000; ++i) {
    auto sut = buses.open_hid(address);
    ASSERT_TRUE(sut.has_value());
    sut.value()->submit(OutBytes{});
    if (i % 3 == 0) {
      ASSERT_TRUE(buses.unplug(address).has_value());
      EXPECT_EQ(sut.value()->submit(OutBytes{}), IoStatus::Disconnected);
      ASSERT_TRUE(buses.replug(address).has_value());
    }
  }
  is_over.store(true);
  servo.join();
}

TEST_F(SimHidTest, PlugRefusesWhatCannotWork) {
  const auto code = [&](const char* where, std::unique_ptr<plugin::SimHidModel> model) {
    const Result<void> result = buses.plug({where}, std::move(model));
    return result.has_value() ? std::string("accepted")
                              : std::string(to_string(result.error().code));
  };
  EXPECT_EQ(code("sim:a", std::make_unique<ScriptedHidModel>(script)), "busy");
  EXPECT_EQ(code("sim:b", nullptr), "invalid argument");
  EXPECT_EQ(code("sim:c", std::make_unique<ScriptedHidModel>(script, Duration(0))),
            "invalid argument");
  EXPECT_EQ(buses.list().size(), 1U);
  EXPECT_EQ(buses.arm_backend(address), nullptr);
  EXPECT_EQ(buses.arm_backend({"sim:unknown"}), nullptr);
}

}  // namespace
}  // namespace thimble::sim
