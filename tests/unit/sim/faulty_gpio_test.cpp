#include "sim/fault/faulty_gpio.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "sim/bus/sim_gpio.hpp"
#include "sim/time/virtual_clock.hpp"

namespace thimble::sim {
namespace {

using std::chrono::milliseconds;

constexpr MonotonicTime at_ms(int ms) { return {milliseconds(ms)}; }

ScriptedFault during(FaultKind kind, int from_ms, int lasts_ms) {
  ScriptedFault fault;
  fault.kind = kind;
  fault.from = at_ms(from_ms);
  fault.lasts = milliseconds(lasts_ms);
  return fault;
}
ScriptedFault of_number(FaultKind kind, std::uint64_t first, std::uint64_t reports = 1) {
  ScriptedFault fault;
  fault.kind = kind;
  fault.first_report = first;
  fault.reports = reports;
  return fault;
}

// Two inputs, lines 0 and 1, and an output, line 2, behind an adapter with a plan.
class Adapter {
 public:
  explicit Adapter(FaultPlan plan) : plan_(std::move(plan)) { open(); }
  explicit Adapter(const ScriptedFault& fault) : Adapter(FaultPlan{1, {fault}, {}}) {}

  void open() {
    sut.reset();
    auto lines = chips_.open({"chip", {"0", "1"}, {"2"}}, nullptr);
    if (lines) sut = *std::move(lines);
  }
  void pass(int ms = 1) { clock.run_for(milliseconds(ms)); }
  // Line 0 changes every millisecond; the numbers of the edges that were told.
  std::vector<std::uint64_t> toggle(int times) {
    std::vector<std::uint64_t> told;
    for (int i = 0; i < times; ++i) {
      chip.set_level(0, !chip.level(0));
      for (bus::GpioEdge edge; sut->next_edge(edge) == IoStatus::Ok;) told.push_back(edge.sequence);
      pass();
    }
    return told;
  }
  std::uint64_t injected(FaultKind kind) { return chips_.injected().of(kind); }

  VirtualClock clock;
  SimGpioChip chip{clock, "chip", 3};
  std::unique_ptr<bus::GpioLines> sut;

 private:
  SimGpioChips below_{{&chip}};
  FaultPlan plan_;
  FaultyGpioChips chips_{below_, clock, plan_};
};

using Numbers = std::vector<std::uint64_t>;

TEST(FaultyGpio, WithoutAPlanPassesEverythingOn) {
  Adapter adapter{FaultPlan{}};
  EXPECT_EQ(adapter.toggle(4), (Numbers{1, 2, 3, 4}));
  EXPECT_EQ(adapter.sut->set(0, true), IoStatus::Ok);
  EXPECT_TRUE(adapter.chip.level(2));
  bus::GpioLevels levels;
  adapter.chip.set_level(1, true);
  ASSERT_EQ(adapter.sut->levels(levels), IoStatus::Ok);
  EXPECT_EQ(levels.high, 2U);
  EXPECT_EQ(levels.read_at, adapter.clock.now());
}

TEST(FaultyGpio, AnEdgeThatIsDroppedLeavesAGap) {
  Adapter adapter(of_number(FaultKind::DropIn, 2, 2));
  EXPECT_EQ(adapter.toggle(5), (Numbers{1, 4, 5}));
  EXPECT_EQ(adapter.injected(FaultKind::DropIn), 2U);
}

TEST(FaultyGpio, AnEdgeMaySayTheOtherLevel) {
  Adapter adapter(of_number(FaultKind::CorruptIn, 1));
  adapter.chip.set_level(0, true);
  bus::GpioEdge edge;
  ASSERT_EQ(adapter.sut->next_edge(edge), IoStatus::Ok);
  EXPECT_FALSE(edge.is_high);
}

TEST(FaultyGpio, ALateEdgeIsStampedWhenItIsToldAndNoneOvertakesIt) {
  ScriptedFault late = of_number(FaultKind::DelayIn, 1);
  late.delay = milliseconds(3);
  Adapter adapter(late);
  EXPECT_EQ(adapter.toggle(3), Numbers{});
  bus::GpioEdge edge;
  for (std::uint64_t number = 1; number <= 3; ++number) {
    ASSERT_EQ(adapter.sut->next_edge(edge), IoStatus::Ok);
    EXPECT_EQ(edge.sequence, number);
    EXPECT_EQ(edge.arrived_at, at_ms(3));
  }
}

TEST(FaultyGpio, AReadingThatIsDroppedLetsTheLastOneGetOld) {
  Adapter adapter(during(FaultKind::DropIn, 5, 5));
  bus::GpioLevels levels;
  adapter.pass(2);
  ASSERT_EQ(adapter.sut->levels(levels), IoStatus::Ok);
  adapter.chip.set_level(1, true);
  adapter.pass(6);
  ASSERT_EQ(adapter.sut->levels(levels), IoStatus::Ok);
  EXPECT_EQ(levels.high, 0U);
  EXPECT_EQ(levels.read_at, at_ms(2));
  adapter.pass(4);
  ASSERT_EQ(adapter.sut->levels(levels), IoStatus::Ok);
  EXPECT_EQ(levels.high, 2U);
}

TEST(FaultyGpio, AReadingMayHaveOneInputTheOtherWayRound) {
  Adapter adapter(of_number(FaultKind::CorruptIn, 1));
  bus::GpioLevels levels;
  ASSERT_EQ(adapter.sut->levels(levels), IoStatus::Ok);
  EXPECT_TRUE(levels.high == 1U || levels.high == 2U);
  adapter.pass();
  ASSERT_EQ(adapter.sut->levels(levels), IoStatus::Ok);
  EXPECT_EQ(levels.high, 0U);
}

TEST(FaultyGpio, AStalledChipAnswersNothingAndEdgesWait) {
  Adapter adapter(during(FaultKind::Stall, 2, 3));
  bus::GpioLevels levels;
  ASSERT_EQ(adapter.sut->levels(levels), IoStatus::Ok);
  adapter.pass(2);
  adapter.chip.set_level(0, true);
  bus::GpioEdge edge;
  EXPECT_EQ(adapter.sut->next_edge(edge), IoStatus::NoData);
  ASSERT_EQ(adapter.sut->levels(levels), IoStatus::Ok);
  EXPECT_EQ(levels.read_at, at_ms(0)) << "and so it gets old";
  EXPECT_EQ(adapter.sut->set(0, true), IoStatus::Backlogged);
  EXPECT_FALSE(adapter.chip.level(2));
  adapter.pass(3);
  EXPECT_EQ(adapter.sut->next_edge(edge), IoStatus::Ok);
  EXPECT_FALSE(adapter.chip.level(2)) << "it was told that it did not get there";
}

TEST(FaultyGpio, ALevelOutMayBeLostWrongOrLate) {
  Adapter lost(of_number(FaultKind::DropOut, 1));
  EXPECT_EQ(lost.sut->set(0, true), IoStatus::Ok) << "nobody can tell";
  EXPECT_FALSE(lost.chip.level(2));
  Adapter wrong(of_number(FaultKind::CorruptOut, 2));
  EXPECT_EQ(wrong.sut->set(0, true), IoStatus::Ok);
  EXPECT_EQ(wrong.sut->set(0, true), IoStatus::Ok);
  EXPECT_FALSE(wrong.chip.level(2));
  ScriptedFault fault = of_number(FaultKind::DelayOut, 1);
  fault.delay = milliseconds(2);
  Adapter late(fault);
  EXPECT_EQ(late.sut->set(0, true), IoStatus::Ok);
  bus::GpioEdge edge;
  late.pass(2);
  EXPECT_FALSE(late.chip.level(2));
  (void)late.sut->next_edge(edge);
  EXPECT_TRUE(late.chip.level(2));
}

TEST(FaultyGpio, DisconnectLatchesUntilItIsOpenedAnewAndOpeningMayBeRefused) {
  FaultPlan plan;
  plan.script = {during(FaultKind::Disconnect, 2, 1), during(FaultKind::RefuseOpen, 5, 2)};
  Adapter adapter(plan);
  bus::GpioEdge edge;
  bus::GpioLevels levels;
  adapter.pass(2);
  EXPECT_EQ(adapter.sut->levels(levels), IoStatus::Disconnected);
  adapter.pass(3);
  EXPECT_EQ(adapter.sut->next_edge(edge), IoStatus::Disconnected);
  EXPECT_EQ(adapter.sut->set(0, true), IoStatus::Disconnected);
  adapter.open();
  EXPECT_EQ(adapter.sut, nullptr) << "refused";
  adapter.pass(2);
  adapter.open();
  ASSERT_NE(adapter.sut, nullptr);
  EXPECT_EQ(adapter.sut->levels(levels), IoStatus::Ok);
}

// Whatever the plan: edges come in their order, each once, and those that do not come were counted.
TEST(FaultyGpio, ARandomPlanLosesNothingThatItDoesNotCount) {
  std::uint64_t lost = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    std::mt19937 random(seed);
    FaultPlan plan;
    plan.seed = seed;
    plan.random.drop_in = 0.001 * static_cast<double>(random() % 200);
    plan.random.delay_in = 0.001 * static_cast<double>(random() % 200);
    plan.random.corrupt_in = 0.001 * static_cast<double>(random() % 200);
    plan.random.max_delay = milliseconds(1 + random() % 10);
    Adapter adapter(plan);
    const Numbers told = adapter.toggle(500);
    adapter.pass(20);
    Numbers rest = told;
    for (bus::GpioEdge edge; adapter.sut->next_edge(edge) == IoStatus::Ok;) {
      EXPECT_LE(edge.arrived_at, adapter.clock.now());
      rest.push_back(edge.sequence);
    }
    for (std::size_t i = 1; i < rest.size(); ++i) ASSERT_LT(rest[i - 1], rest[i]) << seed;
    ASSERT_EQ(rest.size() + adapter.injected(FaultKind::DropIn), 500U) << seed;
    lost += adapter.injected(FaultKind::DropIn);
  }
  EXPECT_GT(lost, 500U);
}

TEST(FaultyGpio, TheSamePlanIsTheSameTwiceAndAnotherSeedIsNot) {
  const auto played = [](std::uint64_t seed) {
    FaultPlan plan;
    plan.seed = seed;
    plan.random.drop_in = 0.2;
    return Adapter(plan).toggle(200);
  };
  EXPECT_EQ(played(1), played(1));
  EXPECT_NE(played(1), played(2));
}

}  // namespace
}  // namespace thimble::sim
