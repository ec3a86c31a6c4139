#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "sim/fault/short_reports.hpp"
#include "tests/unit/sim/bad_cable.hpp"

namespace thimble::sim {
namespace {

// What the device received, by the number in each report's first byte.
std::vector<int> received_of(const Bench& bench) {
  std::vector<int> numbers;
  for (const auto& report : bench.script->received) numbers.push_back(report[0]);
  return numbers;
}

TEST(FaultyHid, DelaysOutputAndLetsNoneOvertake) {
  ScriptedFault delay = for_reports(FaultKind::DelayOut, 2, 1);
  delay.delay = milliseconds(3);
  Bench bench(script_of(delay));
  std::vector<std::size_t> arrived;
  for (std::uint8_t i = 1; i <= 7; ++i) {
    const IoStatus status = bench.sut->submit(OutBytes{i});
    EXPECT_EQ(status, i == 5 ? IoStatus::Backlogged : IoStatus::Ok) << "the host cannot tell";
    bench.clock.run_for(milliseconds(1));
    arrived.push_back(bench.script->received.size());
  }
  EXPECT_EQ(arrived, (std::vector<std::size_t>{1, 1, 1, 1, 2, 3, 4}));
  EXPECT_EQ(received_of(bench), (std::vector<int>{1, 5, 6, 7}))
      << "of those that leave together the newest arrives";
  EXPECT_EQ(bench.injected(FaultKind::DelayOut), 1U);
  EXPECT_EQ(bench.sut->counters().reports_out, 4U);
  EXPECT_EQ(bench.sut->counters().writes_superseded, 3U);
}

TEST(FaultyHid, TellsHowManyOutputReportsAreUnderWay) {
  ScriptedFault delay = during(FaultKind::DelayOut, 0, 2);
  delay.delay = milliseconds(5);
  Bench bench(script_of(delay));
  const auto under_way = [&] { return bench.faulty.injected(kAddress).out_under_way; };
  EXPECT_EQ(under_way(), 0U);
  for (std::uint64_t i = 1; i <= 4; ++i) {
    bench.sut->submit(OutBytes{});
    EXPECT_EQ(under_way(), i);
    bench.clock.run_for(milliseconds(1));
  }
  bench.clock.run_for(milliseconds(2));
  bench.read_frames(1);
  EXPECT_EQ(under_way(), 0U) << "a read lets them out, too";
  bench.sut.reset();
  bench.sut = bench.faulty.open_hid(kAddress).value();
  EXPECT_EQ(under_way(), 0U);
}

TEST(FaultyHid, AHandleThatIsClosedTakesItsDelayedOutputAlong) {
  ScriptedFault delay = during(FaultKind::DelayOut, 0, 100);
  delay.delay = milliseconds(5);
  Bench bench(script_of(delay));
  bench.sut->submit(OutBytes{1});
  bench.sut.reset();
  EXPECT_EQ(bench.faulty.injected(kAddress).out_under_way, 0U);
  bench.clock.run_for(milliseconds(20));
  EXPECT_TRUE(bench.script->received.empty());
}

// 64 wait at most: a mailbox as all others, in which the newest counts.
TEST(FaultyHid, TheNewestOutputArrivesHoweverManyWait) {
  ScriptedFault delay = during(FaultKind::DelayOut, 0, 20);
  delay.delay = milliseconds(10);
  Bench bench(script_of(delay));
  for (std::uint8_t i = 1; i <= 200; ++i) {
    EXPECT_EQ(bench.sut->submit(OutBytes{i}), IoStatus::Ok);
    bench.clock.run_for(microseconds(10));
  }
  bench.read_frames(20);
  ASSERT_FALSE(bench.script->received.empty());
  EXPECT_EQ(received_of(bench).back(), 200);
  const bus::HidCounters counters = bench.sut->counters();
  EXPECT_EQ(counters.reports_out + counters.writes_superseded, 200U);
}

TEST(FaultyHid, AStallHoldsWhatIsDelayed) {
  ScriptedFault delay = for_reports(FaultKind::DelayOut, 1, 1);
  delay.delay = milliseconds(2);
  FaultPlan plan = script_of(delay);
  plan.script.push_back(during(FaultKind::Stall, 1, 5));
  Bench bench(plan);
  bench.sut->submit(OutBytes{1});
  bench.read_frames(5);
  EXPECT_TRUE(bench.script->received.empty());
  bench.read_frames(2);
  EXPECT_EQ(received_of(bench), (std::vector<int>{1}));
}

TEST(ShortReports, CutsWhatThePlanSaysAndNothingElse) {
  ShortReports sut;
  const OutBytes report{1, 2, 3};
  EXPECT_EQ(sut.pass(report, at_ms(0)).size(), report.size()) << "without a plan";
  FaultPlan plan = script_of(during(FaultKind::TruncateOut, 1, 2));
  plan.script.push_back(during(FaultKind::DropOut, 0, 100));
  sut.set_plan(plan);
  for (int ms = 0; ms < 6; ++ms) {
    const auto left = sut.pass(report, at_ms(ms));
    EXPECT_EQ(left.size() < report.size(), ms == 1 || ms == 2) << ms;
    EXPECT_TRUE(std::equal(left.begin(), left.end(), report.begin()));
  }
  EXPECT_EQ(sut.cut(), 2U);
  EXPECT_TRUE(sut.pass({}, at_ms(1)).empty());
}

TEST(ShortReports, CutsByChanceToEveryLengthAndTheSameEachTime) {
  std::array<int, ScriptedHidModel::kOutputBytes + 1> seen{};
  ShortReports first;
  ShortReports second;
  FaultPlan plan;
  plan.seed = 5;
  plan.random.truncate_out = 0.2;
  first.set_plan(plan);
  second.set_plan(plan);
  for (int i = 0; i < 10'000; ++i) {
    const std::size_t size = first.pass(OutBytes{}, {}).size();
    ++seen[size];
    ASSERT_EQ(second.pass(OutBytes{}, at_ms(i)).size(), size) << "the time does not matter";
  }
  EXPECT_NEAR(static_cast<double>(first.cut()), 2000, 200);
  for (std::size_t size = 0; size < OutBytes{}.size(); ++size) EXPECT_GT(seen[size], 150) << size;
}

}  // namespace
}  // namespace thimble::sim
