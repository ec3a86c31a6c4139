#include "sim/fault/faulty_hid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "sim/time/trace_hash.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/unit/sim/bad_cable.hpp"

namespace thimble::sim {
namespace {

TEST(FaultyHid, DropsInputByTime) {
  Bench bench(script_of(during(FaultKind::DropIn, 3, 2)));
  EXPECT_EQ(bench.read_frames(6), (std::vector<int>{1, 2, 0, 0, 5, 6}));
  EXPECT_EQ(bench.injected(FaultKind::DropIn), 2U);
  EXPECT_EQ(bench.sut->counters().reports_in, 4U);
  EXPECT_EQ(bench.sut->counters().reports_skipped, 0U);
}

TEST(FaultyHid, DropsInputByNumber) {
  Bench bench(script_of(for_reports(FaultKind::DropIn, 2, 3)));
  EXPECT_EQ(bench.read_frames(6), (std::vector<int>{1, 0, 0, 0, 5, 6}));
}

TEST(FaultyHid, ADroppedReportLeavesNoGapInTheSequence) {
  Bench bench(script_of(for_reports(FaultKind::DropIn, 1, 2)));
  bench.clock.run_for(milliseconds(1));
  bus::HidReport report;
  EXPECT_EQ(bench.sut->read_newest(report), IoStatus::NoData);
  bench.clock.run_for(milliseconds(1));
  EXPECT_EQ(bench.sut->read_newest(report), IoStatus::NoData);
  bench.clock.run_for(milliseconds(1));
  ASSERT_EQ(bench.sut->read_newest(report), IoStatus::Ok);
  EXPECT_EQ(report.sequence, 1U);
}

TEST(FaultyHid, DropsOutput) {
  Bench bench(script_of(for_reports(FaultKind::DropOut, 2, 1)));
  for (std::uint8_t i = 1; i <= 3; ++i) {
    EXPECT_EQ(bench.sut->submit(OutBytes{i}), IoStatus::Ok) << "the host cannot tell";
    bench.clock.run_for(milliseconds(1));
  }
  ASSERT_EQ(bench.script->received.size(), 2U);
  EXPECT_EQ(bench.script->received[1][0], 3);
  EXPECT_EQ(bench.injected(FaultKind::DropOut), 1U);
  EXPECT_EQ(bench.sut->counters().reports_out, 3U);
}

TEST(FaultyHid, DelaysInputAndStampsItsArrival) {
  ScriptedFault delay = for_reports(FaultKind::DelayIn, 2, 1);
  delay.delay = microseconds(2500);
  Bench bench(script_of(delay));
  bus::HidReport report;
  EXPECT_EQ(bench.read_frames(3), (std::vector<int>{1, 0, 0})) << "report 3 must not overtake";
  bench.clock.run_for(milliseconds(2));

  ASSERT_EQ(bench.sut->read_newest(report), IoStatus::Ok);
  EXPECT_EQ(report.bytes[0], 5);
  EXPECT_EQ(bench.sut->counters().reports_in, 5U);
  EXPECT_EQ(bench.sut->counters().reports_skipped, 3U);
}

TEST(FaultyHid, ADelayedReportIsStampedWhenItIsLetThrough) {
  ScriptedFault delay;
  delay.kind = FaultKind::DelayIn;
  delay.delay = microseconds(1500);
  Bench bench(script_of(delay));
  EXPECT_EQ(bench.read_frames(2), (std::vector<int>{0, 0}));
  bench.clock.run_for(milliseconds(1));
  bus::HidReport report;
  ASSERT_EQ(bench.sut->read_newest(report), IoStatus::Ok);
  EXPECT_EQ(report.bytes[0], 1);
  EXPECT_EQ(report.arrived_at, MonotonicTime{microseconds(2500)});
}

TEST(FaultyHid, CorruptsExactlyOneByteOfInput) {
  Bench bench(script_of(for_reports(FaultKind::CorruptIn, 1, 50)));
  for (int frame = 1; frame <= 60; ++frame) {
    bench.clock.run_for(milliseconds(1));
    bus::HidReport report;
    ASSERT_EQ(bench.sut->read_newest(report), IoStatus::Ok);
    int changed = 0;
    for (const std::uint8_t byte : report.payload()) changed += byte != frame ? 1 : 0;
    ASSERT_EQ(changed, frame <= 50 ? 1 : 0) << frame;
  }
  EXPECT_EQ(bench.injected(FaultKind::CorruptIn), 50U);
}

TEST(FaultyHid, CorruptsExactlyOneByteOfOutput) {
  Bench bench(script_of(for_reports(FaultKind::CorruptOut, 1, 1)));
  for (int i = 0; i < 2; ++i) {
    bench.sut->submit(OutBytes{});
    bench.clock.run_for(milliseconds(1));
  }
  ASSERT_EQ(bench.script->received.size(), 2U);
  EXPECT_EQ(std::count(bench.script->received[0].begin(), bench.script->received[0].end(), 0), 7);
  EXPECT_EQ(std::count(bench.script->received[1].begin(), bench.script->received[1].end(), 0), 8);
}

TEST(FaultyHid, TruncatesInput) {
  Bench bench(script_of(during(FaultKind::TruncateIn, 0, 100)));
  for (int frame = 1; frame <= 50; ++frame) {
    bench.clock.run_for(milliseconds(1));
    bus::HidReport report;
    ASSERT_EQ(bench.sut->read_newest(report), IoStatus::Ok);
    ASSERT_LT(report.size, ScriptedHidModel::kInputBytes);
  }
  EXPECT_EQ(bench.injected(FaultKind::TruncateIn), 50U);
}

TEST(FaultyHid, AStallLosesInputAndHoldsTheNewestOutput) {
  Bench bench(script_of(during(FaultKind::Stall, 2, 3)));
  EXPECT_EQ(bench.read_frames(2), (std::vector<int>{1, 0}));
  EXPECT_EQ(bench.sut->submit(OutBytes{1}), IoStatus::Backlogged);
  EXPECT_EQ(bench.sut->submit(OutBytes{2}), IoStatus::Backlogged);
  EXPECT_EQ(bench.read_frames(2), (std::vector<int>{0, 0}));
  EXPECT_TRUE(bench.script->received.empty());

  EXPECT_EQ(bench.read_frames(2), (std::vector<int>{5, 6}));

  ASSERT_EQ(bench.script->received.size(), 1U);
  EXPECT_EQ(bench.script->received[0][0], 2);
  EXPECT_EQ(bench.sut->counters().writes_superseded, 1U);
  EXPECT_EQ(bench.sut->counters().reports_in, 3U);
  EXPECT_EQ(bench.injected(FaultKind::Stall), 5U) << "three reports lost, two held";
}

TEST(FaultyHid, ABlockedWriteHoldsTheNewestOutputWhileInputPasses) {
  ScriptedFault blocked = during(FaultKind::Stall, 2, 3);
  blocked.endpoint = kHidOut;
  Bench bench(script_of(blocked));
  EXPECT_EQ(bench.read_frames(2), (std::vector<int>{1, 2}));
  EXPECT_EQ(bench.sut->submit(OutBytes{1}), IoStatus::Backlogged);
  EXPECT_EQ(bench.sut->submit(OutBytes{2}), IoStatus::Backlogged);
  EXPECT_EQ(bench.read_frames(2), (std::vector<int>{3, 4}));
  EXPECT_TRUE(bench.script->received.empty());
  EXPECT_EQ(bench.read_frames(2), (std::vector<int>{5, 6}));
  ASSERT_EQ(bench.script->received.size(), 1U);
  EXPECT_EQ(bench.script->received[0][0], 2);
  EXPECT_EQ(bench.sut->counters().writes_superseded, 1U);
  EXPECT_EQ(bench.sut->submit(OutBytes{3}), IoStatus::Ok);
}

TEST(FaultyHid, ASubmitAfterAStallReplacesTheHeldOne) {
  Bench bench(script_of(during(FaultKind::Stall, 0, 2)));
  bench.sut->submit(OutBytes{1});
  bench.clock.run_for(milliseconds(2));
  EXPECT_EQ(bench.sut->submit(OutBytes{2}), IoStatus::Ok);
  bench.read_frames(3);
  ASSERT_EQ(bench.script->received.size(), 1U);
  EXPECT_EQ(bench.script->received[0][0], 2);
  EXPECT_EQ(bench.sut->counters().writes_superseded, 1U);
}

TEST(FaultyHid, ADisconnectLatchesForTheHandleOnly) {
  Bench bench(script_of(during(FaultKind::Disconnect, 3, 1)));
  EXPECT_EQ(bench.read_frames(2), (std::vector<int>{1, 2}));
  bus::HidReport report;
  for (int i = 0; i < 3; ++i) {
    bench.clock.run_for(milliseconds(1));
    EXPECT_EQ(bench.sut->read_newest(report), IoStatus::Disconnected);
    EXPECT_EQ(bench.sut->submit(OutBytes{}), IoStatus::Disconnected);
  }
  EXPECT_EQ(bench.injected(FaultKind::Disconnect), 1U);
  EXPECT_EQ(bench.faulty.list().size(), 1U);
}

TEST(FaultyHid, AHandleOpenedAfterADisconnectWorks) {
  Bench bench(script_of(during(FaultKind::Disconnect, 3, 1)));
  bench.read_frames(4);
  bench.sut.reset();
  bench.sut = bench.faulty.open_hid(kAddress).value();
  EXPECT_EQ(bench.read_frames(2), (std::vector<int>{5, 6}));
}

TEST(FaultyEnumerator, RefusesToOpenWhileSomebodyElseHoldsTheDevice) {
  Bench bench(script_of(during(FaultKind::RefuseOpen, 1, 2)));
  bench.sut.reset();
  bench.clock.run_for(milliseconds(1));
  const auto refused = bench.faulty.open_hid(kAddress);
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, Errc::Busy);
  EXPECT_EQ(bench.injected(FaultKind::RefuseOpen), 1U);
  bench.clock.run_for(milliseconds(2));
  EXPECT_TRUE(bench.faulty.open_hid(kAddress).has_value());
}

TEST(FaultyEnumerator, LosesEventsForGoodAndDelaysThemUntilTheEnd) {
  Bench lost(script_of(during(FaultKind::LoseEvents, 0, 2)));
  EXPECT_FALSE(lost.faulty.poll_event().has_value());
  lost.clock.run_for(milliseconds(2));
  EXPECT_FALSE(lost.faulty.poll_event().has_value());
  EXPECT_EQ(lost.injected(FaultKind::LoseEvents), 1U);
  Bench delayed(script_of(during(FaultKind::DelayEvents, 0, 2)));
  EXPECT_FALSE(delayed.faulty.poll_event().has_value());
  delayed.clock.run_for(milliseconds(2));
  const auto event = delayed.faulty.poll_event();
  ASSERT_TRUE(event.has_value());
  EXPECT_EQ(event->kind, bus::BusEvent::Kind::Arrived);
}

TEST(FaultyEnumerator, CountsEachEventThatIsDelayedOnceAndKeepsTheirOrder) {
  Bench bench(script_of(during(FaultKind::DelayEvents, 0, 5)));
  EXPECT_FALSE(bench.faulty.poll_event().has_value());
  EXPECT_FALSE(bench.faulty.poll_event().has_value());
  EXPECT_EQ(bench.injected(FaultKind::DelayEvents), 1U) << "its arrival, however often asked for";
  bench.clock.run_for(milliseconds(2));
  ASSERT_TRUE(bench.buses.unplug(kAddress).has_value());
  EXPECT_FALSE(bench.faulty.poll_event().has_value());
  EXPECT_EQ(bench.injected(FaultKind::DelayEvents), 2U);

  bench.clock.run_for(milliseconds(4));
  ASSERT_TRUE(bench.buses.replug(kAddress).has_value());
  std::vector<bus::BusEvent::Kind> told;
  while (const auto event = bench.faulty.poll_event()) told.push_back(event->kind);
  using Kind = bus::BusEvent::Kind;
  EXPECT_EQ(told, (std::vector<Kind>{Kind::Arrived, Kind::Left, Kind::Arrived}));
  EXPECT_EQ(bench.injected(FaultKind::DelayEvents), 2U) << "the last came after the window";
}

TEST(FaultyEnumerator, AWindowInWhichNothingHappensDelaysNothing) {
  Bench bench(script_of(during(FaultKind::DelayEvents, 3, 2)));
  ASSERT_TRUE(bench.faulty.poll_event().has_value());
  bench.clock.run_for(milliseconds(4));
  EXPECT_FALSE(bench.faulty.poll_event().has_value());
  EXPECT_EQ(bench.injected(FaultKind::DelayEvents), 0U);
}

TEST(FaultyHid, ARealUnplugPassesThrough) {
  Bench bench({});
  ASSERT_TRUE(bench.buses.unplug(kAddress).has_value());
  bus::HidReport report;
  EXPECT_EQ(bench.sut->read_newest(report), IoStatus::Disconnected);
  EXPECT_EQ(bench.sut->submit(OutBytes{}), IoStatus::Disconnected);
}

FaultPlan random_plan(std::uint64_t seed) {
  FaultPlan plan;
  plan.seed = seed;
  plan.random = {.drop_in = 0.1,
                 .drop_out = 0.1,
                 .delay_in = 0.1,
                 .delay_out = 0.1,
                 .corrupt_in = 0.1,
                 .corrupt_out = 0.1,
                 .truncate_in = 0.1,
                 .stall = 0.02,
                 .max_delay = milliseconds(3),
                 .stall_lasts = milliseconds(4)};
  return plan;
}

struct Traffic {
  std::uint64_t hash{0};
  FaultCounts injected;
};

Traffic run_random(std::uint64_t seed) {
  Bench bench(random_plan(seed));
  TraceHash trace;
  std::uint64_t read = 0;
  MonotonicTime last_arrival{};
  for (int tick = 0; tick < 200; ++tick) {
    bench.clock.run_for(milliseconds(1));
    bus::HidReport report;
    trace.add(static_cast<int>(bench.sut->submit(OutBytes{static_cast<std::uint8_t>(tick)})));
    if (bench.sut->read_newest(report) != IoStatus::Ok) continue;
    ++read;
    EXPECT_GE(report.arrived_at, last_arrival);
    EXPECT_LE(report.arrived_at, bench.clock.now());
    last_arrival = report.arrived_at;
    trace.add(report.payload());
    trace.add(report.sequence);
    EXPECT_EQ(report.sequence, read + bench.sut->counters().reports_skipped);
  }
  for (const auto& report : bench.script->received) trace.add(report);
  return {trace.value(), bench.faulty.injected(kAddress)};
}

TEST(FaultyHid, SameSeedGivesTheSameFaults) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    EXPECT_EQ(run_random(seed).hash, run_random(seed).hash);
    EXPECT_NE(run_random(seed).hash, run_random(seed + 100).hash);
  }
}

TEST(FaultyHid, EveryRandomFaultHappensAboutAsOftenAsOrdered) {
  FaultCounts total;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const FaultCounts counts = run_random(seed).injected;
    for (std::size_t i = 0; i < kFaultKindCount; ++i) total.by_kind[i] += counts.by_kind[i];
  }
  // At most 10,000 reports, fewer as stalls swallow some; a tenth of those, within a factor.
  for (const FaultKind kind :
       {FaultKind::DropIn, FaultKind::DropOut, FaultKind::DelayIn, FaultKind::DelayOut,
        FaultKind::CorruptIn, FaultKind::CorruptOut, FaultKind::TruncateIn}) {
    EXPECT_GT(total.of(kind), 600U) << static_cast<int>(kind);
    EXPECT_LT(total.of(kind), 1100U) << static_cast<int>(kind);
  }
  EXPECT_GT(total.of(FaultKind::Stall), 500U);
  EXPECT_EQ(total.of(FaultKind::Disconnect), 0U);
}

TEST(FaultyHid, WhatHappensToAReportDoesNotDependOnHowOftenSomebodyReads) {
  FaultPlan plan;
  plan.seed = 4;
  plan.random.corrupt_in = 0.5;
  Bench often(plan);
  Bench seldom(plan);
  for (int i = 0; i < 30; ++i) {
    bus::HidReport a;
    bus::HidReport b;
    for (int k = 0; k < 3; ++k) {
      often.clock.run_for(milliseconds(1));
      ASSERT_EQ(often.sut->read_newest(a), IoStatus::Ok);
    }
    seldom.clock.run_for(milliseconds(3));
    ASSERT_EQ(seldom.sut->read_newest(b), IoStatus::Ok);
    ASSERT_EQ(a.bytes, b.bytes);
  }
}

TEST(FaultyHid, AnExchangeAllocatesNothing) {
  Bench bench(random_plan(3));
  bus::HidReport report;
  std::uint64_t allocations = 0;
  for (int tick = 0; tick < 200; ++tick) {
    bench.clock.run_for(milliseconds(1));
    const std::uint64_t before = test::allocation_count();
    bench.sut->read_newest(report);
    bench.sut->submit(OutBytes{});
    allocations += test::allocation_count() - before;
  }
  EXPECT_EQ(allocations, 0U);
}

}  // namespace
}  // namespace thimble::sim
