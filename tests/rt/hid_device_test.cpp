// linux::HidHost and its devices with their threads, over the hidapi of tests/support.
#include "hal/linux/hid_device.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <memory>
#include <thread>
#include <vector>

#include "hal/linux/monotonic_clock.hpp"
#include "tests/rt/held_opening.hpp"
#include "tests/rt/wait_until.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/fake_hid_kernel.hpp"
#include "tests/support/fake_hidapi.hpp"
#include "tests/support/look_again.hpp"

namespace thimble::linux {
namespace {

using test::FakeHidWire;
using Report = FakeHidWire::Report;

constexpr std::size_t kBytes = 14;

struct HidDeviceTest : testing::Test {
  MonotonicClock clock;
  FakeHidWire wire;
  test::FakeHidKernel kernel;  // of hiddev, where a test says that there is one
  std::unique_ptr<HidHost> host = make_host(clock);
  bus::BusDeviceInfo info;

  HidDeviceTest() {
    info.address = {"hid:1"};
    info.kind = bus::BusKind::Hid;
    info.input_report_bytes = kBytes;
    info.output_report_bytes = kBytes;
  }
  ~HidDeviceTest() override {
    wire.release_writes();
    host.reset();
    EXPECT_EQ(wire.breaches(), std::vector<std::string>{});
    EXPECT_EQ(FakeHidWire::alive(), 0);
  }
  std::unique_ptr<HidHost> make_host(const Clock& its_clock) {
    return std::make_unique<HidHost>(BusSettings{its_clock, {.name = "hid-test"}, {}}, kernel);
  }
  Result<std::unique_ptr<bus::HidDevice>> open() { return host->open({wire.node(), ""}, info); }
  // Of one that nobody has: a stalled machine may not have opened it within the host's patience.
  Result<std::unique_ptr<bus::HidDevice>> open_free() {
    return test::look_again({Errc::Busy}, [this] { return open(); });
  }
  static Report report(std::uint8_t seed) { return Report(kBytes, seed); }
};

TEST_F(HidDeviceTest, ReportsGoBothWays) {
  const auto sut = open_free().value();
  bus::HidReport read;
  for (std::uint8_t i = 1; i <= 20; ++i) {
    wire.device_sends(report(i));
    EXPECT_TRUE(test::wait_until([&] { return sut->read_newest(read) == IoStatus::Ok; })) << +i;
    EXPECT_EQ(read.bytes[0], i);
    sut->submit(report(i));
    EXPECT_TRUE(test::wait_until([&] { return wire.received_by_device().size() == i; })) << +i;
  }
  EXPECT_EQ(wire.received_by_device().back(), report(20));
}

TEST_F(HidDeviceTest, AWriteThatNeverEndsHoldsUpNeitherReadingNorSubmitting) {
  const auto sut = open_free().value();
  wire.block_writes();
  EXPECT_EQ(sut->submit(report(1)), IoStatus::Ok);
  ASSERT_TRUE(test::wait_until([&] { return wire.is_write_blocked(); }));
  bus::HidReport read;
  for (std::uint8_t i = 2; i < 100; ++i) {
    EXPECT_EQ(sut->submit(report(i)), IoStatus::Backlogged);
    wire.device_sends(report(i));
    ASSERT_TRUE(test::wait_until([&] { return sut->read_newest(read) == IoStatus::Ok; })) << +i;
  }
  wire.release_writes();
  ASSERT_TRUE(test::wait_until([&] { return sut->counters().reports_out == 2; }));
  EXPECT_EQ(wire.received_by_device(), (std::vector<Report>{report(1), report(99)}));
  EXPECT_EQ(sut->counters().writes_superseded, 97U);
  EXPECT_TRUE(test::wait_until([&] { return sut->submit(report(1)) == IoStatus::Ok; }));
}

TEST_F(HidDeviceTest, ClosingUnderABlockedWriteIsBoundedAndTheNewestIsWrittenLast) {
  auto sut = open_free().value();
  wire.block_writes();
  sut->submit(report(1));
  ASSERT_TRUE(test::wait_until([&] { return wire.is_write_blocked(); }));
  sut->submit(report(2));
  sut->submit(report(0));
  sut.reset();
  EXPECT_EQ(host->lingering(), 1U) << "the kernel has it still";
  const auto again = open();
  ASSERT_FALSE(again.has_value());
  EXPECT_EQ(again.error().code, Errc::Busy);
  EXPECT_NE(again.error().message.find("hid:1"), std::string::npos);
  wire.release_writes();
  EXPECT_TRUE(test::wait_until([&] { return host->lingering() == 0; }));
  EXPECT_EQ(wire.received_by_device(), (std::vector<Report>{report(1), report(0)}));
  EXPECT_TRUE(open_free().has_value());
}

// Stands still when told to: who waits with a patience then waits until something happens. Knows
// how often one thread has asked it.
class AskedClock final : public Clock {
 public:
  [[nodiscard]] MonotonicTime now() const noexcept override {
    if (std::this_thread::get_id() == watched_.load()) ++asked_;
    return is_frozen_ ? frozen_ : running_.now();
  }
  Duration sleep_until(MonotonicTime) noexcept override { return {}; }
  void freeze() {
    frozen_ = running_.now();
    is_frozen_ = true;
  }
  void watch_this_thread() { watched_ = std::this_thread::get_id(); }
  [[nodiscard]] int asked() const noexcept { return asked_; }

 private:
  MonotonicClock running_;
  MonotonicTime frozen_{};
  std::atomic<bool> is_frozen_{false};
  std::atomic<std::thread::id> watched_{};
  mutable std::atomic<int> asked_{0};
};

TEST_F(HidDeviceTest, ToOpenASickDeviceAnewHoldsUpNoOtherOne) {
  AskedClock still;
  host = make_host(still);
  FakeHidWire other_wire;
  bus::BusDeviceInfo other = info;
  other.address = {"hid:2"};
  auto sick = open_free().value();
  wire.block_writes();
  sick->submit(report(1));
  ASSERT_TRUE(test::wait_until([&] { return wire.is_write_blocked(); }));
  sick.reset();
  ASSERT_EQ(host->lingering(), 1U);
  still.freeze();
  auto again = std::async(std::launch::async, [&] {
    still.watch_this_thread();
    return open().has_value();
  });
  // Whether the old one has ended by now: twice; then how long to wait for it.
  EXPECT_TRUE(test::wait_until([&] { return still.asked() > 2; }));
  auto beside = std::async(std::launch::async, [&] {
    return host->open({other_wire.node(), ""}, other).has_value();
  });
  EXPECT_EQ(beside.wait_for(std::chrono::seconds(20)), std::future_status::ready);
  wire.release_writes();
  EXPECT_TRUE(beside.get());
  EXPECT_TRUE(again.get());
  host.reset();
}

TEST_F(HidDeviceTest, ANodeThatHangsWhenItIsOpenedHoldsUpNoOtherOne) {
  AskedClock still;
  host = make_host(still);
  FakeHidWire other_wire;
  bus::BusDeviceInfo other = info;
  other.address = {"hid:2"};
  still.freeze();
  test::HeldOpening held(wire.node());
  auto sick = std::async(std::launch::async, [&] { return open().has_value(); });
  EXPECT_TRUE(test::wait_until([&] { return held.waiting() > 0; }));
  auto beside = std::async(std::launch::async, [&] {
    return host->open({other_wire.node(), ""}, other).has_value();
  });
  EXPECT_EQ(beside.wait_for(std::chrono::seconds(20)), std::future_status::ready);
  held.release();
  EXPECT_TRUE(beside.get());
  EXPECT_TRUE(sick.get());
  host.reset();
}

TEST_F(HidDeviceTest, AnOpeningThatLastsIsCalledThatAndEndsByItself) {
  test::HeldOpening held(wire.node());
  for (int i = 0; i < 3; ++i) {
    const auto sut = open();
    ASSERT_FALSE(sut.has_value()) << i;
    EXPECT_EQ(sut.error().code, Errc::Busy) << i;
    EXPECT_NE(sut.error().message.find("hid:1: the kernel has not opened it yet"),
              std::string::npos)
        << sut.error().message;
    EXPECT_EQ(host->lingering(), 1U) << "it is not tried beside the one that hangs";
  }
  held.release();
  EXPECT_TRUE(test::wait_until([&] { return host->lingering() == 0; }));
  EXPECT_TRUE(open_free().has_value());
}

TEST_F(HidDeviceTest, WhatWasSubmittedLastIsWrittenBeforeItCloses) {
  for (int i = 0; i < 50; ++i) {
    const std::size_t before = wire.received_by_device().size();
    auto sut = open_free().value();
    sut->submit(report(9));
    sut->submit(report(0));
    sut.reset();
    ASSERT_TRUE(test::wait_until([&] { return host->lingering() == 0; }));
    ASSERT_GT(wire.received_by_device().size(), before);
    EXPECT_EQ(wire.received_by_device().back(), report(0));
  }
}

TEST_F(HidDeviceTest, AnUnplugShowsInBandEvenDuringAWrite) {
  const auto sut = open_free().value();
  wire.block_writes();
  sut->submit(report(1));
  ASSERT_TRUE(test::wait_until([&] { return wire.is_write_blocked(); }));
  sut->submit(report(2));
  wire.unplug();
  bus::HidReport read;
  EXPECT_TRUE(test::wait_until([&] { return sut->read_newest(read) == IoStatus::Disconnected; }));
  EXPECT_EQ(sut->submit(report(3)), IoStatus::Disconnected);
  EXPECT_TRUE(wire.received_by_device().empty());
}

TEST_F(HidDeviceTest, AnExchangeAllocatesNothingInTheThreadOfTheServo) {
  const auto sut = open_free().value();
  const Report command = report(2);
  const Report answer = report(1);
  bus::HidReport read;
  std::uint64_t allocated = 0;
  for (int tick = 0; tick < 500; ++tick) {
    wire.device_sends(answer);
    const std::uint64_t before = test::allocation_count();
    sut->submit(command);
    sut->read_newest(read);
    allocated += test::allocation_count() - before;
  }
  EXPECT_EQ(allocated, 0U);
}

TEST_F(HidDeviceTest, OpeningAndClosingInAHurryLeaksNothing) {
  for (int i = 0; i < 100; ++i) {
    auto sut = open();
    if (!sut.has_value()) continue;  // not closed in time by a stalled machine
    (*sut)->submit(report(1));
    wire.device_sends(report(1));
  }
  EXPECT_TRUE(test::wait_until([&] { return host->lingering() == 0; }));
  EXPECT_EQ(FakeHidWire::alive(), 0);
}

// Any file will do: who answers is the test's kernel.
struct HidDeviceOverHiddev : HidDeviceTest {
  HidDeviceOverHiddev() { kernel.fields = {{kBytes}}; }
  std::unique_ptr<HidDevice> open_both() {
    const HidNodes nodes{wire.node(), "/dev/null"};
    return test::look_again({Errc::Busy}, [&] { return host->open(nodes, info); }).value();
  }
};

TEST_F(HidDeviceOverHiddev, WhatIsSubmittedLeavesByThatAloneAndSoDoesAGuardsZero) {
  auto sut = open_both();
  const auto shared = share_again(*sut->shared().lock());
  ASSERT_TRUE(shared.has_value()) << shared.error().message;
  EXPECT_EQ(shared->way, NodeWay::Hiddev);
  EXPECT_EQ(::fcntl(shared->node.get(), F_GETFL) & O_ACCMODE, O_RDONLY) << "the hiddev node's file";
  sut->submit(report(9));
  sut->submit(report(3));
  sut.reset();
  host.reset();
  ASSERT_FALSE(kernel.sent.empty());
  EXPECT_EQ(kernel.sent.back(), (test::FakeHidKernel::Report{"dev", report(3)}));
  EXPECT_TRUE(wire.received_by_device().empty());
}

// What it answers then would be a sample that it never sent.
TEST_F(HidDeviceOverHiddev, WhatTheKernelAsksItForIsAskedBeforeAnybodyReads) {
  bool is_asked_before = false;
  wire.at_next_opening([&] { is_asked_before = kernel.is_initialized; });
  const auto sut = open_both();
  EXPECT_TRUE(is_asked_before);
}

// Another device's writer holds hidraw's lock: nothing of ours waits for it.
TEST_F(HidDeviceOverHiddev, AHidrawThatTakesNothingHoldsNothingUp) {
  const auto sut = open_both();
  wire.block_writes();
  bus::HidReport read;
  for (std::uint8_t i = 1; i < 50; ++i) {
    EXPECT_TRUE(test::wait_until([&] { return sut->submit(report(i)) == IoStatus::Ok; })) << +i;
    wire.device_sends(report(i));
    ASSERT_TRUE(test::wait_until([&] { return sut->read_newest(read) == IoStatus::Ok; })) << +i;
  }
  EXPECT_TRUE(test::wait_until([&] { return sut->counters().reports_out > 40; }));
  EXPECT_FALSE(wire.is_write_blocked());
}

// As while a device is reset: what the kernel takes at once waits in its queue, and zeros must find
// room there.
TEST_F(HidDeviceOverHiddev, AKernelThatTakesAllAtOnceIsGivenNoMoreThanOneAFrame) {
  AskedClock still;
  host = make_host(still);
  auto sut = open_both();
  still.freeze();  // no write takes any time
  std::vector<MonotonicTime> sent_at;
  kernel.on_send = [&] { sent_at.push_back(clock.now()); };
  while (sut->counters().reports_out < 20) sut->submit(report(1));
  sut.reset();
  host.reset();
  ASSERT_GE(sent_at.size(), 20U);
  for (std::size_t i = 1; i < 20; ++i) {
    EXPECT_GE(sent_at[i] - sent_at[i - 1], std::chrono::microseconds(990)) << i;
  }
}

TEST_F(HidDeviceOverHiddev, OneThatDoesNotTakeTheReportAsItIsIsLeftAlone) {
  for (const auto& fields : {std::vector<test::FakeHidKernel::Field>{},
                             std::vector<test::FakeHidKernel::Field>{{kBytes - 1}}}) {
    kernel.fields = fields;
    auto sut = open_both();
    EXPECT_EQ(sut->shared().lock()->way, NodeWay::HidrawAfterZero);
    sut->submit(report(4));
    sut.reset();
    ASSERT_TRUE(test::wait_until([&] { return host->lingering() == 0; }));
    EXPECT_EQ(wire.received_by_device().back(), report(4));
  }
  EXPECT_TRUE(kernel.sent.empty());
}

TEST_F(HidDeviceTest, ARefusalNamesTheDeviceAndWhy) {
  const auto sut = open_free().value();
  const auto second = open();
  ASSERT_FALSE(second.has_value());
  EXPECT_EQ(second.error().code, Errc::Busy);
  EXPECT_NE(second.error().message.find("hid:1"), std::string::npos);
  const HidNodes none{wire.node() + "0", ""};
  const auto nowhere = test::look_again({Errc::Busy}, [&] { return host->open(none, info); });
  ASSERT_FALSE(nowhere.has_value());
  EXPECT_EQ(nowhere.error().code, Errc::NotFound);
  info.input_report_bytes = bus::kMaxHidReportBytes + 1;
  EXPECT_EQ(open().error().code, Errc::Unsupported);
}

}  // namespace
}  // namespace thimble::linux
