// Requests to endpoint 0, and every fault of a USB device at once.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "sim/fault/faulty_usb.hpp"
#include "sim/time/trace_hash.hpp"
#include "tests/unit/sim/usb_bench.hpp"

namespace thimble::sim {
namespace {

using bus::UsbOutcome;
using std::chrono::milliseconds;

TEST(FaultyUsb, ADroppedRequestNeverEnds) {
  FaultPlan plan = plan_of(FaultKind::DropOut, 1);
  plan.script[0].endpoint = 0;
  UsbBench bench(plan);
  bus::UsbControlReply reply;
  EXPECT_EQ(bench.transact(bus::UsbControlRequest{}, reply), IoStatus::NoData);
  bench.clock.run_for(milliseconds(1000));
  EXPECT_EQ(bench.sut->read_control(reply), IoStatus::NoData);
  EXPECT_EQ(bench.sut->start_control(bus::UsbControlRequest{}), IoStatus::Backlogged);
  EXPECT_TRUE(bench.script->requests.empty());
  EXPECT_EQ(bench.submit(1).size(), 1U) << "the pipes work";
}

TEST(FaultyUsb, AHaltedRequestIsRefusedAndTheNextWorks) {
  UsbBench bench(plan_of(FaultKind::Halt, 1));
  bus::UsbControlReply reply;
  EXPECT_EQ(bench.transact(bus::UsbControlRequest{}, reply), IoStatus::Ok);
  EXPECT_EQ(reply.outcome, UsbOutcome::Stalled);
  EXPECT_EQ(bench.transact(bus::UsbControlRequest{}, reply), IoStatus::Ok);
  EXPECT_EQ(reply.outcome, UsbOutcome::Done);
  EXPECT_EQ(bench.sut->counters(0).stalls, 1U);
  EXPECT_EQ(bench.sut->counters(0).packets_out, 1U);
}

TEST(FaultyUsb, AnAnswerToARequestIsSpoilt) {
  const Packet answer(8, 7);
  const auto reply_under = [&](FaultKind kind) {
    UsbBench bench(plan_of(kind, 1));
    bench.script->control_answer = answer;
    bus::UsbControlReply reply;
    reply.size = 99;
    bench.transact(request_for_data(), reply);
    EXPECT_EQ(bench.injected(kind), 1U);
    return reply;
  };
  EXPECT_EQ(reply_under(FaultKind::DropIn).size, 99U) << "it never came";
  EXPECT_EQ(reply_under(FaultKind::Babble).outcome, UsbOutcome::Babbled);
  EXPECT_LT(reply_under(FaultKind::TruncateIn).size, 8U);
  const bus::UsbControlReply corrupt = reply_under(FaultKind::CorruptIn);
  EXPECT_EQ(std::count(corrupt.data.begin(), corrupt.data.begin() + 8, 7), 7);
}

TEST(FaultyUsb, ARequestIsCorruptedOrDelayedOnItsWay) {
  FaultPlan plan = plan_of(FaultKind::CorruptOut, 1);
  plan.script.push_back(plan_of(FaultKind::DelayOut, 1).script[0]);
  plan.script[1].delay = milliseconds(3);
  UsbBench bench(plan);
  bus::UsbControlRequest request;
  request.length = 4;
  bus::UsbControlReply reply;
  EXPECT_EQ(bench.transact(request, reply), IoStatus::NoData);
  bench.clock.run_for(milliseconds(2));
  EXPECT_EQ(bench.sut->read_control(reply), IoStatus::NoData);
  bench.clock.run_for(milliseconds(1));
  EXPECT_EQ(bench.sut->read_control(reply), IoStatus::Ok);
  ASSERT_EQ(bench.script->requests.size(), 1U);
  EXPECT_NE(bench.script->requests[0].data, request.data);
}

struct RandomRun {
  std::uint64_t hash{0};
  FaultCounts injected;
};

// Every fault by chance at once. Whatever happens, the counters add up and bytes stay in bounds.
RandomRun run_random(std::uint64_t seed) {
  FaultPlan plan;
  plan.seed = seed;
  plan.random = {.drop_in = 0.05,
                 .drop_out = 0.05,
                 .delay_in = 0.1,
                 .delay_out = 0.1,
                 .corrupt_in = 0.1,
                 .corrupt_out = 0.1,
                 .truncate_in = 0.1,
                 .truncate_out = 0.1,
                 .stall = 0.05,
                 .halt = 0.05,
                 .babble = 0.05,
                 .max_delay = milliseconds(4),
                 .stall_lasts = milliseconds(3)};
  UsbBench bench(plan);
  std::mt19937_64 random(seed);
  TraceHash trace;
  bus::UsbPacket packet;
  bus::UsbControlReply reply;
  std::uint64_t submitted = 0;
  std::uint64_t read = 0;
  std::uint64_t sequence = 0;
  const auto drain = [&] {
    while (bench.sut->read(kIn, packet) == IoStatus::Ok) {
      ++read;
      EXPECT_GT(packet.sequence, sequence);
      EXPECT_LE(packet.size, 64U);
      sequence = packet.sequence;
      trace.add(packet.payload());
      trace.add(packet.arrived_at.since_epoch.count());
    }
  };
  for (int ms = 0; ms < 400; ++ms) {
    if (random() % 2 == 0) bench.script->to_send[kIn].push_back(Packet(1 + random() % 64, 3));
    if (random() % 2 == 0) {
      bench.sut->submit(kOut, Packet(1 + random() % 64, 5));
      ++submitted;
    }
    if (random() % 4 == 0) bench.sut->start_control(request_for_data());
    if (random() % 2 == 0) bench.sut->read_control(reply);
    bench.clock.run_for(milliseconds(1));
    drain();
  }
  bench.clock.run_for(milliseconds(500));
  for (int ms = 0; ms < 50; ++ms) {
    bench.clock.run_for(milliseconds(10));
    drain();
  }
  for (const Packet& received : bench.script->received[kOut]) trace.add(received);

  const bus::UsbCounters out = bench.sut->counters(kOut);
  EXPECT_EQ(out.packets_out + out.writes_superseded + out.stalls, submitted);
  const bus::UsbCounters in = bench.sut->counters(kIn);
  EXPECT_EQ(in.packets_in, read + in.packets_skipped);
  return {trace.value(), bench.faulty.injected(kUsbAddress)};
}

TEST(FaultyUsb, EveryFaultByChanceKeepsTheCountersInBalance) {
  FaultCounts total;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const FaultCounts counts = run_random(seed).injected;
    for (std::size_t i = 0; i < kFaultKindCount; ++i) total.by_kind[i] += counts.by_kind[i];
  }
  for (const FaultKind kind :
       {FaultKind::DropIn, FaultKind::DropOut, FaultKind::DelayIn, FaultKind::DelayOut,
        FaultKind::CorruptIn, FaultKind::CorruptOut, FaultKind::TruncateIn, FaultKind::TruncateOut,
        FaultKind::Stall, FaultKind::Halt, FaultKind::Babble}) {
    EXPECT_GT(total.of(kind), 0U) << static_cast<int>(kind);
  }
}

TEST(FaultyUsb, TheSamePlanGivesTheSameTrace) {
  EXPECT_EQ(run_random(7).hash, run_random(7).hash);
  EXPECT_NE(run_random(7).hash, run_random(8).hash);
}

}  // namespace
}  // namespace thimble::sim
