#include "sim/fault/faulty_memory_window.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "sim/bus/sim_memory_window.hpp"
#include "sim/time/virtual_clock.hpp"

namespace thimble::sim {
namespace {

using std::chrono::milliseconds;
using Words = std::vector<std::uint32_t>;

// 16 words of 7 each, in a slot with a plan.
struct WindowBench {
  VirtualClock clock;
  std::shared_ptr<SimMemory> memory = std::make_shared<SimMemory>(64);
  FaultyMemoryWindow sut;

  explicit WindowBench(const FaultPlan& plan)
      : sut(std::make_unique<SimMemoryWindow>(memory), clock, plan) {
    for (std::uint32_t at = 0; at < 64; at += 4) memory->words().store(at, 7);
  }
  std::uint32_t read() {
    std::uint32_t word = 0;
    EXPECT_EQ(sut.read(4, word), IoStatus::Ok);
    return word;
  }
  Words read_all() {
    Words words(16);
    EXPECT_EQ(sut.read_block(0, words), IoStatus::Ok);
    return words;
  }
};

FaultPlan plan_of(FaultKind kind, std::uint64_t report) {
  FaultPlan plan;
  plan.script.push_back({.kind = kind, .first_report = report, .reports = 1});
  return plan;
}
FaultPlan plan_from(FaultKind kind, int from_ms, int lasts_ms) {
  FaultPlan plan;
  plan.script.push_back(
      {.kind = kind, .from = {milliseconds(from_ms)}, .lasts = milliseconds(lasts_ms)});
  return plan;
}

TEST(FaultyMemoryWindow, ALostReadIsAllOnesOnce) {
  WindowBench bench(plan_of(FaultKind::DropIn, 2));
  EXPECT_EQ(bench.read(), 7U);
  EXPECT_EQ(bench.read(), bus::kNobodyAnswers);
  EXPECT_EQ(bench.read(), 7U);
  EXPECT_EQ(bench.sut.injected().of(FaultKind::DropIn), 1U);
}

TEST(FaultyMemoryWindow, ALostWriteChangesNothing) {
  WindowBench bench(plan_of(FaultKind::DropOut, 1));
  EXPECT_EQ(bench.sut.write(4, 9), IoStatus::Ok);
  EXPECT_EQ(bench.read(), 7U);
  EXPECT_EQ(bench.sut.write(4, 9), IoStatus::Ok);
  EXPECT_EQ(bench.read(), 9U);
}

TEST(FaultyMemoryWindow, ACorruptedWordHasOneOtherByte) {
  WindowBench in(plan_of(FaultKind::CorruptIn, 1));
  const std::uint32_t seen = in.read() ^ 7U;
  EXPECT_EQ(in.read(), 7U) << "the memory is as it was";
  WindowBench out(plan_of(FaultKind::CorruptOut, 1));
  EXPECT_EQ(out.sut.write(4, 9), IoStatus::Ok);
  for (const std::uint32_t changed : {seen, out.read() ^ 9U}) {
    int bytes = 0;
    for (int i = 0; i < 4; ++i) bytes += ((changed >> (8 * i)) & 0xffU) != 0 ? 1 : 0;
    EXPECT_EQ(bytes, 1) << changed;
  }
}

TEST(FaultyMemoryWindow, ACutBlockKeepsItsBeginning) {
  WindowBench in(plan_of(FaultKind::TruncateIn, 1));
  const Words words = in.read_all();
  const auto first_lost = std::find(words.begin(), words.end(), bus::kNobodyAnswers);
  EXPECT_NE(first_lost, words.end());
  EXPECT_TRUE(std::all_of(words.begin(), first_lost, [](auto word) { return word == 7; }));
  EXPECT_TRUE(
      std::all_of(first_lost, words.end(), [](auto word) { return word == bus::kNobodyAnswers; }));
  WindowBench out(plan_of(FaultKind::TruncateOut, 1));
  EXPECT_EQ(out.sut.write_block(0, Words(16, 9)), IoStatus::Ok);
  const Words after = out.read_all();
  const auto first_old = std::find(after.begin(), after.end(), 7U);
  EXPECT_NE(first_old, after.end());
  EXPECT_TRUE(std::all_of(first_old, after.end(), [](auto word) { return word == 7; }));
}

TEST(FaultyMemoryWindow, AStalledBoardReadsAllOnesAndTakesNothingUntilItComesBack) {
  WindowBench bench(plan_from(FaultKind::Stall, 10, 5));
  EXPECT_EQ(bench.read(), 7U);
  bench.clock.run_for(milliseconds(10));
  EXPECT_EQ(bench.read(), bus::kNobodyAnswers);
  EXPECT_EQ(bench.sut.write(4, 9), IoStatus::Ok);
  bench.clock.run_for(milliseconds(5));
  EXPECT_EQ(bench.read(), 7U);
}

TEST(FaultyMemoryWindow, ADisconnectLatches) {
  WindowBench bench(plan_from(FaultKind::Disconnect, 10, 1));
  bench.clock.run_for(milliseconds(10));
  std::uint32_t word = 0;
  EXPECT_EQ(bench.sut.read(4, word), IoStatus::Disconnected);
  bench.clock.run_for(milliseconds(10));
  EXPECT_EQ(bench.sut.write(4, 9), IoStatus::Disconnected);
  EXPECT_EQ(bench.sut.injected().of(FaultKind::Disconnect), 1U);
}

TEST(FaultyMemoryWindow, WhatIsRefusedUsesUpNoFault) {
  WindowBench bench(plan_of(FaultKind::DropOut, 1));
  EXPECT_EQ(bench.sut.write(2, 9), IoStatus::ProtocolError);
  EXPECT_EQ(bench.sut.write_block(60, Words(2)), IoStatus::ProtocolError);
  EXPECT_EQ(bench.sut.injected().of(FaultKind::DropOut), 0U);
  EXPECT_EQ(bench.sut.write(4, 9), IoStatus::Ok);
  EXPECT_EQ(bench.sut.injected().of(FaultKind::DropOut), 1U);
}

TEST(FaultyMemoryWindow, ByChanceTheSameSeedDoesTheSame) {
  FaultPlan plan;
  plan.seed = 3;
  plan.random = {.drop_in = 0.1, .corrupt_in = 0.1, .stall = 0.02, .stall_lasts = milliseconds(3)};
  WindowBench one(plan);
  WindowBench other(plan);
  int damaged = 0;
  for (int i = 0; i < 500; ++i) {
    const std::uint32_t word = one.read();
    ASSERT_EQ(other.read(), word) << i;
    damaged += word != 7 ? 1 : 0;
    one.clock.run_for(milliseconds(1));
    other.clock.run_for(milliseconds(1));
  }
  EXPECT_GT(damaged, 50);
  EXPECT_LT(damaged, 250);
}

}  // namespace
}  // namespace thimble::sim
