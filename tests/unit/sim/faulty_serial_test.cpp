#include "sim/fault/faulty_serial.hpp"

#include <gtest/gtest.h>

#include <string>

#include "sim/bus/sim_enumerator.hpp"
#include "sim/fault/faulty_enumerator.hpp"
#include "sim/time/virtual_clock.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/scripted_serial_model.hpp"

namespace thimble::sim {
namespace {

using std::chrono::milliseconds;

constexpr const char* kLine = "[12345]\n";

// A line behind a cable with a plan; the device says, and is told, one line a millisecond.
struct SerialBench {
  const bus::DeviceAddress address{"sim:a"};
  VirtualClock clock;
  SimEnumerator buses{clock};
  FaultyEnumerator faulty{buses, clock};
  std::shared_ptr<test::SerialModelScript> script = std::make_shared<test::SerialModelScript>();
  std::unique_ptr<bus::SerialPort> sut;

  explicit SerialBench(const FaultPlan& plan) {
    EXPECT_TRUE(buses.plug(address, std::make_unique<test::ScriptedSerialModel>(script)));
    faulty.set_plan(address, plan);
    sut = faulty.open_serial(address, {}).value();
  }
  std::string read_all() {
    std::string text;
    bus::SerialChunk chunk;
    while (sut->read(chunk) == IoStatus::Ok) {
      EXPECT_GT(chunk.size, 0U);
      text.append(chunk.payload().begin(), chunk.payload().end());
    }
    return text;
  }
  std::string stream(int lines) {
    std::string seen;
    for (int i = 0; i < lines; ++i) {
      const std::string line(kLine);
      script->to_send.insert(script->to_send.end(), line.begin(), line.end());
      clock.run_for(milliseconds(1));
      seen += read_all();
    }
    return seen;
  }
  std::string tell(int lines) {
    const std::string line(kLine);
    const std::vector<std::uint8_t> message(line.begin(), line.end());
    for (int i = 0; i < lines; ++i) {
      static_cast<void>(sut->submit(message));
      clock.run_for(milliseconds(1));
    }
    return {script->received.begin(), script->received.end()};
  }
  std::uint64_t injected(FaultKind kind) const { return faulty.injected(address).of(kind); }
};

FaultPlan plan_of(FaultKind kind, std::uint64_t report) {
  ScriptedFault fault;
  fault.kind = kind;
  fault.first_report = report;
  fault.reports = 1;
  FaultPlan plan;
  plan.script.push_back(fault);
  return plan;
}

FaultPlan plan_during(FaultKind kind, std::int64_t from_ms, std::int64_t lasts_ms) {
  ScriptedFault fault;
  fault.kind = kind;
  fault.from = {milliseconds(from_ms)};
  fault.lasts = milliseconds(lasts_ms);
  FaultPlan plan;
  plan.script.push_back(fault);
  return plan;
}

std::string lines(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += kLine;
  return text;
}

TEST(FaultySerial, WithoutAPlanNothingGoesWrong) {
  SerialBench bench({});
  EXPECT_EQ(bench.stream(5), lines(5));
  EXPECT_EQ(bench.tell(5), lines(5));
}

TEST(FaultySerial, DroppedBytesLeaveAHoleInTheStream) {
  SerialBench bench(plan_of(FaultKind::DropIn, 2));
  EXPECT_EQ(bench.stream(3), lines(2));
  EXPECT_EQ(bench.injected(FaultKind::DropIn), 1U);
}

TEST(FaultySerial, ACorruptedChunkDiffersInOneByte) {
  SerialBench bench(plan_of(FaultKind::CorruptIn, 1));
  const std::string seen = bench.stream(1);
  const std::string sent = lines(1);
  ASSERT_EQ(seen.size(), sent.size());
  int differing = 0;
  for (std::size_t i = 0; i < sent.size(); ++i) differing += seen[i] != sent[i] ? 1 : 0;
  EXPECT_EQ(differing, 1);
}

TEST(FaultySerial, ALateChunkOvertakesNothing) {
  FaultPlan plan = plan_of(FaultKind::DelayIn, 1);
  plan.script[0].delay = milliseconds(3);
  SerialBench bench(plan);
  EXPECT_EQ(bench.stream(2), "");
  EXPECT_EQ(bench.stream(2), lines(4));
}

TEST(FaultySerial, AShortChunkAndAShortMessageAreABeginning) {
  FaultPlan plan = plan_of(FaultKind::TruncateIn, 1);
  plan.script.push_back(plan_of(FaultKind::TruncateOut, 1).script[0]);
  SerialBench bench(plan);
  const std::string seen = bench.stream(1);
  EXPECT_LT(seen.size(), lines(1).size());
  EXPECT_TRUE(lines(1).starts_with(seen));
  const std::string told = bench.tell(1);
  EXPECT_LT(told.size(), lines(1).size());
  EXPECT_TRUE(lines(1).starts_with(told));
  EXPECT_EQ(bench.sut->counters().writes_failed, 1U);
}

TEST(FaultySerial, ADroppedMessageNeverReachesTheDevice) {
  SerialBench bench(plan_of(FaultKind::DropOut, 2));
  EXPECT_EQ(bench.tell(3), lines(2));
}

TEST(FaultySerial, ALineThatHangsPassesNothingAndLosesNoInput) {
  SerialBench bench(plan_during(FaultKind::Stall, 2, 3));
  EXPECT_EQ(bench.stream(4), lines(1));
  EXPECT_EQ(bench.stream(2), lines(5));
}

TEST(FaultySerial, APortThatDiesIsDisconnectedForGood) {
  SerialBench bench(plan_during(FaultKind::Disconnect, 2, 1));
  EXPECT_EQ(bench.stream(1), lines(1));
  bench.clock.run_for(milliseconds(1));
  bus::SerialChunk chunk;
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(bench.sut->read(chunk), IoStatus::Disconnected);
    EXPECT_EQ(bench.sut->submit(std::vector<std::uint8_t>{1}), IoStatus::Disconnected);
    bench.clock.run_for(milliseconds(1));
  }
}

TEST(FaultySerial, APortThatSomebodyElseHoldsIsBusy) {
  SerialBench bench({});
  bench.faulty.set_plan(bench.address, plan_during(FaultKind::RefuseOpen, 0, 10));
  bench.sut.reset();
  const auto refused = bench.faulty.open_serial(bench.address, {});
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, Errc::Busy);
}

TEST(FaultySerial, TheSameSeedGivesTheSameStream) {
  FaultPlan plan;
  plan.random = {.drop_in = 0.1, .corrupt_in = 0.1, .truncate_in = 0.1, .stall = 0.01};
  plan.random.stall_lasts = milliseconds(3);
  const auto run = [&](std::uint64_t seed) {
    plan.seed = seed;
    SerialBench bench(plan);
    return bench.stream(300);
  };
  EXPECT_EQ(run(7), run(7));
  EXPECT_NE(run(7), run(8));
}

}  // namespace
}  // namespace thimble::sim
