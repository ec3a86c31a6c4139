#include "sim/fault/faulty_usb.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/support/allocation_count.hpp"
#include "tests/unit/sim/usb_bench.hpp"

namespace thimble::sim {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using Seen = std::vector<std::vector<int>>;

TEST(FaultyUsb, DropsInputWithoutAGapInTheSequence) {
  UsbBench bench(plan_of(FaultKind::DropIn, 2));
  EXPECT_EQ(bench.stream(2), (Seen{{1}, {}}));
  bench.script->to_send[kIn].push_back({3});
  bench.clock.run_for(milliseconds(1));
  bus::UsbPacket packet;
  ASSERT_EQ(bench.sut->read(kIn, packet), IoStatus::Ok);
  EXPECT_EQ(packet.sequence, 2U);
  EXPECT_EQ(bench.sut->counters(kIn).packets_in, 2U);
  EXPECT_EQ(bench.sut->counters(kIn).packets_skipped, 0U);
  EXPECT_EQ(bench.injected(FaultKind::DropIn), 1U);
}

TEST(FaultyUsb, AFaultOfOneEndpointLeavesTheOthersAlone) {
  FaultPlan plan = plan_of(FaultKind::DropIn, 1, 100);
  plan.script[0].endpoint = kNewestIn;
  UsbBench bench(plan);
  bench.script->to_send[kNewestIn].push_back({9});
  EXPECT_EQ(bench.stream(2), (Seen{{1}, {2}}));
  EXPECT_TRUE(bench.read_all(kNewestIn).empty());
}

TEST(FaultyUsb, DelaysInputInOrderAndStampsItsArrival) {
  FaultPlan plan = plan_of(FaultKind::DelayIn, 2);
  plan.script[0].delay = microseconds(2500);
  UsbBench bench(plan);
  EXPECT_EQ(bench.stream(3), (Seen{{1}, {}, {}})) << "packet 3 must not overtake";
  bench.clock.run_for(milliseconds(1));
  bus::UsbPacket packet;
  ASSERT_EQ(bench.sut->read(kIn, packet), IoStatus::Ok);
  EXPECT_EQ(packet.bytes[0], 2);
  EXPECT_EQ(packet.arrived_at, MonotonicTime{microseconds(1125 + 2500)});
  EXPECT_EQ(bench.read_all(kIn), std::vector<int>{3});
}

TEST(FaultyUsb, OfANewestPipeADelayLetsTheNewestThrough) {
  FaultPlan plan = plan_of(FaultKind::DelayIn, 1);
  plan.script[0].delay = milliseconds(3);
  UsbBench bench(plan);
  for (std::uint8_t i = 1; i <= 3; ++i) bench.script->to_send[kNewestIn].push_back({i});
  for (int i = 0; i < 3; ++i) {
    bench.clock.run_for(milliseconds(1));
    EXPECT_TRUE(bench.read_all(kNewestIn).empty());
  }
  bench.clock.run_for(milliseconds(1));
  EXPECT_EQ(bench.read_all(kNewestIn), std::vector<int>{3});
  EXPECT_EQ(bench.sut->counters(kNewestIn).packets_skipped, 2U);
}

TEST(FaultyUsb, CorruptsExactlyOneByteEachWay) {
  FaultPlan plan = plan_of(FaultKind::CorruptIn, 1);
  plan.script.push_back(plan_of(FaultKind::CorruptOut, 1).script[0]);
  UsbBench bench(plan);
  bench.script->to_send[kIn].push_back(Packet(8, 7));
  bench.clock.run_for(milliseconds(1));
  bus::UsbPacket packet;
  ASSERT_EQ(bench.sut->read(kIn, packet), IoStatus::Ok);
  EXPECT_EQ(std::count(packet.payload().begin(), packet.payload().end(), 7), 7);
  const std::vector<Packet> received = bench.submit(2);
  ASSERT_EQ(received.size(), 2U);
  EXPECT_EQ(std::count(received[0].begin(), received[0].end(), 1), 7);
  EXPECT_EQ(received[1], Packet(8, 2));
}

TEST(FaultyUsb, TruncatesInput) {
  UsbBench bench(plan_of(FaultKind::TruncateIn, 1, 100));
  for (int i = 0; i < 50; ++i) {
    bench.script->to_send[kIn].push_back(Packet(8, 7));
    bench.clock.run_for(milliseconds(1));
    bus::UsbPacket packet;
    ASSERT_EQ(bench.sut->read(kIn, packet), IoStatus::Ok);
    ASSERT_LT(packet.size, 8U);
  }
  EXPECT_EQ(bench.injected(FaultKind::TruncateIn), 50U);
}

TEST(FaultyUsb, AShortWriteReachesTheDeviceInPartAndIsCounted) {
  UsbBench bench(plan_of(FaultKind::TruncateOut, 2, 20));
  const std::vector<Packet> received = bench.submit(22);
  const bus::UsbCounters counters = bench.sut->counters(kOut);
  EXPECT_EQ(counters.packets_out, 22U);
  EXPECT_EQ(counters.writes_cut, 20U);
  EXPECT_EQ(received.front(), Packet(8, 1));
  EXPECT_EQ(received.back(), Packet(8, 22));
  for (std::size_t i = 1; i + 1 < received.size(); ++i) {
    EXPECT_LT(received[i].size(), 8U);
  }
}

TEST(FaultyUsb, AHaltedInputIsLostAndItsReaderTold) {
  UsbBench bench(plan_of(FaultKind::Halt, 2));
  EXPECT_EQ(bench.stream(3), (Seen{{1}, {}, {3}}));
  EXPECT_EQ(bench.sut->counters(kIn).stalls, 1U);
  EXPECT_EQ(bench.sut->counters(kIn).packets_in, 2U);
}

TEST(FaultyUsb, AHaltedOutputIsLostAndItsSenderTold) {
  UsbBench bench(plan_of(FaultKind::Halt, 1));
  EXPECT_EQ(bench.submit(2), std::vector<Packet>{Packet(8, 2)});
  EXPECT_EQ(bench.sut->counters(kOut).stalls, 1U);
  EXPECT_EQ(bench.sut->counters(kOut).packets_out, 1U);
}

TEST(FaultyUsb, BabbleLosesThePacketAndCounts) {
  UsbBench bench(plan_of(FaultKind::Babble, 1, 2));
  EXPECT_EQ(bench.stream(3), (Seen{{}, {}, {3}}));
  EXPECT_EQ(bench.sut->counters(kIn).babbles, 2U);
  EXPECT_EQ(bench.sut->counters(kIn).packets_in, 1U);
}

TEST(FaultyUsb, AWayOutThatFailsEveryTimeNeverLooksFree) {
  for (const FaultKind kind : {FaultKind::Halt, FaultKind::TruncateOut}) {
    UsbBench bench(plan_of(kind, 1, 20));
    for (std::uint8_t i = 0; i < 20; ++i) {
      const IoStatus expected = i == 0 ? IoStatus::Ok : IoStatus::Backlogged;
      EXPECT_EQ(bench.sut->submit(kOut, Packet(8, i)), expected) << int{i};
      bench.clock.run_for(milliseconds(1));
    }
    EXPECT_EQ(bench.injected(kind), 20U);
    EXPECT_EQ(bench.sut->submit(kOut, Packet(8, 50)), IoStatus::Backlogged) << "the last failed";
    bench.clock.run_for(milliseconds(1));
    EXPECT_EQ(bench.sut->submit(kOut, Packet(8, 51)), IoStatus::Ok);
  }
}

TEST(FaultyUsb, ADroppedWriteLooksSent) {
  UsbBench bench(plan_of(FaultKind::DropOut, 1));
  EXPECT_EQ(bench.submit(2), std::vector<Packet>{Packet(8, 2)});
  EXPECT_EQ(bench.sut->counters(kOut).packets_out, 2U);
  EXPECT_EQ(bench.sut->counters(kOut).stalls, 0U);
}

TEST(FaultyUsb, ADelayedWriteKeepsThePipeBusyAndTheNewestWaits) {
  FaultPlan plan = plan_of(FaultKind::DelayOut, 1);
  plan.script[0].delay = milliseconds(5);
  UsbBench bench(plan);
  EXPECT_EQ(bench.sut->submit(kOut, Packet(8, 1)), IoStatus::Backlogged);
  EXPECT_EQ(bench.sut->submit(kOut, Packet(8, 2)), IoStatus::Backlogged);
  EXPECT_EQ(bench.sut->submit(kOut, Packet(8, 3)), IoStatus::Backlogged);
  for (int i = 0; i < 8; ++i) {
    bench.clock.run_for(milliseconds(1));
    bench.read_all(kIn);
  }
  EXPECT_EQ(bench.script->received[kOut], (std::vector<Packet>{Packet(8, 1), Packet(8, 3)}));
  EXPECT_EQ(bench.sut->counters(kOut).packets_out, 2U);
  EXPECT_EQ(bench.sut->counters(kOut).writes_superseded, 1U);
}

TEST(FaultyUsb, AStallLosesNoInputAndHoldsTheNewestOutput) {
  UsbBench bench(plan_during(FaultKind::Stall, 2, 3));
  EXPECT_EQ(bench.stream(4), (Seen{{1}, {}, {}, {}}));
  EXPECT_EQ(bench.sut->submit(kOut, Packet(8, 1)), IoStatus::Backlogged);
  EXPECT_EQ(bench.sut->submit(kOut, Packet(8, 2)), IoStatus::Backlogged);
  EXPECT_EQ(bench.sut->start_control(bus::UsbControlRequest{}), IoStatus::Ok);
  EXPECT_TRUE(bench.script->received[kOut].empty());
  bench.clock.run_for(milliseconds(1));

  bus::UsbPacket packet;
  ASSERT_EQ(bench.sut->read(kIn, packet), IoStatus::Ok);
  EXPECT_EQ(packet.bytes[0], 2);
  EXPECT_EQ(packet.arrived_at, MonotonicTime{milliseconds(5)}) << "it waited in the device";
  EXPECT_EQ(bench.read_all(kIn), (std::vector<int>{3, 4}));
  bench.clock.run_for(milliseconds(1));
  EXPECT_EQ(bench.script->received[kOut], std::vector<Packet>{Packet(8, 2)});
  EXPECT_EQ(bench.script->requests.size(), 1U);
  EXPECT_EQ(bench.sut->counters(kOut).writes_superseded, 1U);
}

TEST(FaultyUsb, ADisconnectLatchesForTheHandleOnly) {
  UsbBench bench(plan_during(FaultKind::Disconnect, 3, 1));
  EXPECT_EQ(bench.stream(2), (Seen{{1}, {2}}));
  bus::UsbPacket packet;
  bus::UsbControlReply reply;
  for (int i = 0; i < 3; ++i) {
    bench.clock.run_for(milliseconds(1));
    EXPECT_EQ(bench.sut->read(kIn, packet), IoStatus::Disconnected);
    EXPECT_EQ(bench.sut->submit(kOut, Packet(8, 1)), IoStatus::Disconnected);
    EXPECT_EQ(bench.sut->start_control({}), IoStatus::Disconnected);
    EXPECT_EQ(bench.sut->read_control(reply), IoStatus::Disconnected);
  }
  EXPECT_EQ(bench.injected(FaultKind::Disconnect), 1U);
  EXPECT_EQ(bench.faulty.list().size(), 1U);
  bench.sut.reset();
  bench.open();
  EXPECT_EQ(bench.submit(1).size(), 1U);
}

TEST(FaultyUsb, AnUnplugStaysEvenWhereAStallHidesIt) {
  UsbBench bench(plan_during(FaultKind::Stall, 3, 100));
  bench.clock.run_for(milliseconds(2));
  ASSERT_TRUE(bench.buses.unplug(kUsbAddress).has_value());
  bus::UsbPacket packet;
  EXPECT_EQ(bench.sut->read(kIn, packet), IoStatus::Disconnected);
  bench.clock.run_for(milliseconds(2));
  EXPECT_EQ(bench.sut->read(kIn, packet), IoStatus::Disconnected);
  EXPECT_EQ(bench.sut->submit(kOut, Packet(8, 1)), IoStatus::Disconnected);
}

TEST(FaultyUsb, RefusesToOpenWhileSomebodyElseHoldsTheDevice) {
  UsbBench bench(plan_during(FaultKind::RefuseOpen, 1, 2));
  bench.sut.reset();
  bench.clock.run_for(milliseconds(1));
  EXPECT_EQ(bench.faulty.open_usb(kUsbAddress, {}).error().code, Errc::Busy);
  bench.clock.run_for(milliseconds(2));
  bench.open();
}

TEST(FaultyUsb, APlanAllocatesNothingInAnExchange) {
  FaultPlan plan = plan_of(FaultKind::DelayIn, 1, 500);
  plan.script[0].delay = milliseconds(2);
  UsbBench bench(plan);
  for (int i = 0; i < 50; ++i) bench.script->to_send[kIn].push_back(Packet(8, 1));
  bench.clock.run_for(milliseconds(10));
  const Packet command(16, 1);
  bus::UsbPacket packet;
  int read = 0;
  const std::uint64_t before = test::allocation_count();
  for (int tick = 0; tick < 100; ++tick) {
    bench.sut->submit(kOut, command);
    if (bench.sut->read(kIn, packet) == IoStatus::Ok) ++read;
  }
  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_EQ(read, 50);
}

}  // namespace
}  // namespace thimble::sim
