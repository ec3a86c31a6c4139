#include "sim/export/plug_pace.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <vector>

namespace thimble::sim {
namespace {

using std::chrono::microseconds;

constexpr Duration kRound{microseconds(125)};

// The machine's clock: a sleep jumps.
class JumpingClock final : public Clock {
 public:
  MonotonicTime now() const noexcept override { return now_; }
  Duration sleep_until(MonotonicTime deadline) noexcept override {
    if (now_ < deadline) now_ = deadline;
    ++sleeps;
    return now_ - deadline;
  }
  int sleeps{0};

 private:
  MonotonicTime now_{std::chrono::seconds(9)};
};

// Rounds by the clock; what it needs and when the kernel speaks is said by the test.
class ScriptedPlug final : public Plug, private Event {
 public:
  ScriptedPlug(VirtualClock& clock, Clock& machine) : clock_(&clock), machine_(&machine) {
    clock.events().schedule_at(*this, clock.now() + kRound);
  }
  Result<void> plug() override { return {}; }
  Result<void> unplug(Supply) override { return {}; }
  bool is_plugged() const noexcept override { return true; }
  bool is_open() const noexcept override { return true; }
  bool is_broken() const noexcept override { return false; }
  bool has_endpoints() const noexcept override { return true; }
  PlugCounters counters() const noexcept override { return {}; }
  Duration round_period() const noexcept override { return kRound; }
  MonotonicTime next_needed() const noexcept override { return clock_->now() + needed * kRound; }
  bool wait_for_kernel(MonotonicTime until) noexcept override {
    const bool is_in_time = heard_at && *heard_at < until;
    machine_->sleep_until(is_in_time ? *heard_at : until);
    return is_in_time;
  }
  void advance_model(MonotonicTime t) noexcept override {
    advanced_to.push_back(t.since_epoch);
    advanced_at.push_back(machine_->now());
  }
  void leave_out_until(MonotonicTime t) noexcept override { left_out_until_ = t; }

  int needed{8};
  std::optional<MonotonicTime> heard_at;  // on the machine's clock
  std::vector<Duration> looked_at;        // since the start
  std::vector<Duration> advanced_to;      // by slices; and when
  std::vector<MonotonicTime> advanced_at;

 private:
  void fire(MonotonicTime now) noexcept override {
    clock_->events().schedule_at(*this, now + kRound);
    if (now >= left_out_until_) looked_at.push_back(now.since_epoch);
  }
  VirtualClock* clock_;
  Clock* machine_;
  MonotonicTime left_out_until_{};
};

// Ties the two clocks in a round that is over when the test begins.
struct Paced : testing::Test {
  explicit Paced(PlugPace::Grain grain) : sut(clock, machine, plug, grain) {
    plug.needed = 1;
    sut.run_next();
    start = machine.now() - kRound;
    plug.looked_at.clear();
  }
  VirtualClock clock;
  JumpingClock machine;
  ScriptedPlug plug{clock, machine};
  PlugPace sut;
  MonotonicTime start;
};

struct PlugPaceTest : Paced {
  PlugPaceTest() : Paced({}) { plug.needed = 8; }
};

TEST_F(PlugPaceTest, RoundsThatNobodyNeedsPassWithoutALook) {
  sut.run_next();
  EXPECT_EQ(plug.looked_at, (std::vector<Duration>{9 * kRound}));
  EXPECT_EQ(machine.now(), start + 9 * kRound);
  EXPECT_EQ(clock.now(), MonotonicTime{9 * kRound});
}

TEST_F(PlugPaceTest, WhereEachIsNeededTheKernelIsNotWaitedFor) {
  plug.needed = 1;
  plug.heard_at = start;
  for (int i = 0; i < 3; ++i) sut.run_next();
  EXPECT_EQ(plug.looked_at, (std::vector<Duration>{2 * kRound, 3 * kRound, 4 * kRound}));
  EXPECT_EQ(machine.now(), start + 4 * kRound);
}

TEST_F(PlugPaceTest, WhatTheKernelSaysIsLookedAtInTheNextRound) {
  plug.heard_at = start + 3 * kRound + microseconds(1);
  sut.run_next();
  EXPECT_EQ(plug.looked_at, (std::vector<Duration>{4 * kRound}));
  EXPECT_EQ(machine.now(), start + 4 * kRound) << "not before its time";
}

TEST_F(PlugPaceTest, AtOnceIfItHadSpokenBefore) {
  plug.heard_at = start;
  sut.run_next();
  EXPECT_EQ(plug.looked_at, (std::vector<Duration>{2 * kRound}));
}

TEST_F(PlugPaceTest, HeardLateItIsNotLookedAtLaterThanNeeded) {
  plug.needed = 3;
  plug.heard_at = start + 4 * kRound - microseconds(1);
  sut.run_next();
  EXPECT_EQ(plug.looked_at, (std::vector<Duration>{4 * kRound}));
}

struct AtOnce : Paced {
  AtOnce() : Paced({.at_once = 16 * kRound}) {}
};

TEST_F(AtOnce, EachRoundThatIsNeededIsRunAtItsOwnTimeOfTheModel) {
  plug.needed = 4;
  plug.heard_at = start;
  sut.run_next();
  EXPECT_EQ(plug.looked_at,
            (std::vector<Duration>{5 * kRound, 9 * kRound, 13 * kRound, 17 * kRound}));
  EXPECT_EQ(clock.now(), MonotonicTime{17 * kRound});
  EXPECT_EQ(machine.now(), start + 17 * kRound) << "at the end of the last, and not later";
}

TEST_F(AtOnce, NothingIsLateAfterAThousand) {
  for (int i = 0; i < 1000; ++i) sut.run_next();
  EXPECT_EQ(plug.looked_at.size(), 16000U);
  EXPECT_EQ(machine.now() - start, clock.now().since_epoch);
}

TEST_F(AtOnce, AMachineThatStallsLongerMakesTheModelLateOnce) {
  machine.sleep_until(machine.now() + std::chrono::seconds(1));
  const MonotonicTime stalled = machine.now();
  sut.run_next();
  const MonotonicTime recovered = machine.now();
  EXPECT_LE(recovered - stalled, 16 * kRound);
  sut.run_next();
  EXPECT_EQ(machine.now() - recovered, 16 * kRound) << "and it is not hurried afterwards";
  EXPECT_EQ(plug.looked_at.size(), 32U);
}

struct InSlices : Paced {
  static constexpr Duration kSlice{5 * kRound / 2};
  InSlices() : Paced({.slice = kSlice}) { plug.needed = 8; }
};

TEST_F(InSlices, TheModelGoesOnAtItsOwnTimeAndIsLookedAtAsEver) {
  sut.run_next();
  const Duration begin = kRound;
  EXPECT_EQ(plug.advanced_to,
            (std::vector<Duration>{begin + kSlice, begin + 2 * kSlice, begin + 3 * kSlice}));
  for (std::size_t i = 0; i < plug.advanced_to.size(); ++i) {
    EXPECT_EQ(plug.advanced_at[i], start + plug.advanced_to[i]) << "neither sooner nor later";
  }
  EXPECT_EQ(plug.looked_at, (std::vector<Duration>{9 * kRound}));
  EXPECT_EQ(machine.now(), start + 9 * kRound);
}

TEST_F(InSlices, EvenWhereTheKernelIsNotWaitedFor) {
  plug.needed = 1;
  PlugPace fine(clock, machine, plug, {.slice = kRound / 5});
  fine.run_next();  // ties its clocks
  for (int i = 0; i < 10; ++i) fine.run_next();
  EXPECT_EQ(plug.advanced_to.size(), 40U);
  EXPECT_EQ(plug.looked_at.size(), 11U);
  EXPECT_EQ(clock.now(), MonotonicTime{12 * kRound});
}

TEST_F(InSlices, WhatTheKernelSaysEndsThemBeforeTheRoundThatHearsIt) {
  plug.heard_at = start + 4 * kRound + microseconds(1);
  sut.run_next();
  EXPECT_EQ(plug.advanced_to, (std::vector<Duration>{kRound + kSlice}));
  EXPECT_EQ(plug.looked_at, (std::vector<Duration>{5 * kRound}));
}

TEST_F(InSlices, AMachineThatStalledLosesNoneAndDoesNoMoreThanAFrameOfThem) {
  machine.sleep_until(machine.now() + std::chrono::seconds(1));
  sut.run_next();
  EXPECT_EQ(plug.advanced_to.size(), 3U);
  EXPECT_EQ(plug.looked_at, (std::vector<Duration>{9 * kRound}));
}

}  // namespace
}  // namespace thimble::sim
