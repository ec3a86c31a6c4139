// An arm that is opened, shared and closed again and again, with the threads that the daemon has:
// for ThreadSanitizer above all.
#include <gtest/gtest.h>

#include <atomic>
#include <deque>
#include <thread>
#include <utility>

#include "daemon/app/device_threads.hpp"
#include "daemon/session/plugins.hpp"
#include "daemon/session/runtime.hpp"
#include "hal/linux/bus_enumerator.hpp"
#include "hal/linux/monotonic_clock.hpp"
#include "tests/rt/wait_until.hpp"
#include "tests/support/fake_hidapi.hpp"
#include "tests/support/mock_machine.hpp"

namespace thimble::test {
namespace {

// A puck, which needs no guard, on a machine that is made up.
struct ArmThreads : testing::Test {
  linux::MonotonicClock clock;
  MockMachine machine;
  std::deque<FakeHidWire> wires;  // the newest is what is plugged in
  session::Plugins plugins;
  linux::BusEnumerator buses{
      linux::BusSettings{clock, {.name = "bus"}, {}},
      [this](const bus::BusDeviceInfo& info) { return plugins.drivers.knows(info); }};
  config::Config config;
  std::unique_ptr<app::DeviceThreads> threads;
  std::unique_ptr<session::Runtime> sut;

  ArmThreads() {
    config.arms.emplace_back().name = "left";
    config.arms.back().device = "hid:P1";
    config.arms.back().world = "box";
    config.worlds.emplace_back().name = "box";
    config.worlds.back().source = "box:3";
    machine.plug_virtual(MockMachine::HidDevice{.ids = "0003:0000046D:0000C626",
                                                .serial_number = "P1",
                                                .report_descriptor = numbered_reports(6, 2)});
    exchange_wire();
  }
  ~ArmThreads() override {
    sut.reset();
    threads.reset();
    EXPECT_TRUE(wait_until([] { return FakeHidWire::alive() == 0; }));
    for (const FakeHidWire& wire : wires) {
      EXPECT_EQ(wire.breaches(), std::vector<std::string>{});
    }
  }
  // The handle that is open dies; a new one leads to a new device.
  void exchange_wire() {
    FakeHidWire& fresh = wires.emplace_back();
    fresh.attach("/dev/hidraw0");
    if (wires.size() > 1) wires[wires.size() - 2].unplug();
  }
  void start() {
    if (threads == nullptr) threads = app::DeviceThreads::start(config).value();
    session::RigParts parts{plugins.models, plugins.drivers};
    parts.real_buses = &buses;
    parts.real_clock = &clock;
    parts.stopwatch = &clock;
    parts.executor_for = [this](const std::string& arm) -> devices::DeviceExecutor& {
      return threads->executor_for(arm);
    };
    auto made = session::Runtime::create(config, parts);
    ASSERT_TRUE(made) << made.error().message;
    sut = *std::move(made);
    ASSERT_TRUE(is_had_at_last()) << sut->arms().front()->trouble();
  }
  session::ArmSession& arm() { return sut->arms().front()->session(); }
  // As the control thread does, until it is so.
  template <class Condition>
  [[nodiscard]] bool look_after_until(const Condition& is_done) {
    return wait_until([&] {
      static_cast<void>(sut->follow_buses(clock.now()));
      static_cast<void>(buses.share({"hid:P1"}));
      return is_done();
    });
  }
  // What a stalled machine has not opened within the start's patience arrives later.
  [[nodiscard]] bool is_had_at_last() {
    const auto is_had = [&] {
      for (session::Runtime::Arrival& arrival : sut->take_arrivals()) {
        static_cast<void>(sut->take_over(std::move(arrival)));
      }
      return sut->arms().front()->trouble().empty();
    };
    return is_had() || look_after_until(is_had);
  }
};

TEST_F(ArmThreads, AnArmThatDiesAgainAndAgainIsOpenedAgainAndShared) {
  ASSERT_NO_FATAL_FAILURE(start());
  std::atomic<bool> is_over{false};
  std::thread servo([&] {
    EXPECT_TRUE(wait_until([&] {
      arm().loop().tick({});
      return is_over.load();
    }));
  });
  for (int i = 0; i < 10; ++i) {
    const auto is_lost = [&] { return arm().snapshot().frame.state == OperatingState::Lost; };
    EXPECT_TRUE(look_after_until([&] { return !is_lost(); })) << i;
    // A report shows that it was had: without one the tries would become rarer.
    EXPECT_TRUE(look_after_until([&] {
      wires.back().device_sends({1, 0, 0, 0, 0, 0, 0});
      return arm().device().has_reported();
    })) << i;
    EXPECT_TRUE(look_after_until([&] { return buses.share({"hid:P1"}).has_value(); })) << i;
    exchange_wire();
    EXPECT_TRUE(look_after_until(is_lost)) << i;
  }
  is_over = true;
  servo.join();
}

TEST_F(ArmThreads, AClosingAndTheNextOpeningOfTheSameArmNeverMeet) {
  for (int i = 0; i < 10; ++i) {
    ASSERT_NO_FATAL_FAILURE(start()) << i;
    EXPECT_TRUE(buses.share({"hid:P1"})) << i;
    sut.reset();  // the closing is under way, or waits, when the next one comes
  }
}

}  // namespace
}  // namespace thimble::test
