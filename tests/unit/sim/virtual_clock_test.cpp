#include "sim/time/virtual_clock.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <vector>

#include "sim/time/trace_hash.hpp"
#include "tests/support/allocation_count.hpp"

namespace thimble::sim {
namespace {

constexpr MonotonicTime at(std::int64_t ns) { return {Duration(ns)}; }

class Periodic final : public Event {
 public:
  Periodic(VirtualClock& clock, Duration period) : clock_(&clock), period_(period) {
    clock.events().schedule_at(*this, clock.now() + period);
  }
  void fire(MonotonicTime now) noexcept override {
    ++count_;
    last_ = now;
    is_consistent_ = is_consistent_ && clock_->now() == now;
    clock_->events().schedule_at(*this, now + period_);
  }
  int count_{0};
  MonotonicTime last_{};
  bool is_consistent_{true};

 private:
  VirtualClock* clock_;
  Duration period_;
};

TEST(VirtualClock, SleepingRunsWhatIsDueAndEndsAtTheDeadline) {
  VirtualClock sut;
  Periodic periodic(sut, Duration(10));

  EXPECT_EQ(sut.sleep_until(at(35)), Duration(0));

  EXPECT_EQ(periodic.count_, 3);
  EXPECT_EQ(periodic.last_, at(30));
  EXPECT_TRUE(periodic.is_consistent_) << "now() is the event's time while it fires";
  EXPECT_EQ(sut.now(), at(35));
}

TEST(VirtualClock, AnEventDueAtTheDeadlineRunsBeforeTheSleeperWakes) {
  VirtualClock sut;
  Periodic periodic(sut, Duration(10));
  sut.sleep_until(at(10));
  EXPECT_EQ(periodic.count_, 1);
}

TEST(VirtualClock, ADeadlineInThePastReturnsHowLateItIsAndMovesNothing) {
  VirtualClock sut(at(100));
  Periodic periodic(sut, Duration(10));

  EXPECT_EQ(sut.sleep_until(at(40)), Duration(60));

  EXPECT_EQ(sut.now(), at(100));
  EXPECT_EQ(periodic.count_, 0);
}

TEST(VirtualClock, AnEventScheduledInThePastRunsAtOnceWithoutTurningTimeBack) {
  VirtualClock sut(at(100));
  Periodic periodic(sut, Duration(10));
  sut.events().schedule_at(periodic, at(5));

  sut.sleep_until(at(100));

  EXPECT_EQ(periodic.count_, 1);
  EXPECT_EQ(periodic.last_, at(100));
}

TEST(VirtualClock, PeriodicEventsAllocateNothing) {
  VirtualClock sut;
  std::vector<std::unique_ptr<Periodic>> events;
  for (int i = 1; i <= 100; ++i) events.push_back(std::make_unique<Periodic>(sut, Duration(i)));
  ASSERT_LE(events.size(), sut.events().capacity());

  const std::uint64_t before = test::allocation_count();
  sut.run_for(Duration(2000));

  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_EQ(events[0]->count_, 2000);
  EXPECT_EQ(events[99]->count_, 20);
}

TEST(VirtualClockDeathTest, ANestedSleepEndsTheProcess) {
  class Sleeper final : public Event {
   public:
    explicit Sleeper(VirtualClock& clock) : clock_(&clock) {}
    void fire(MonotonicTime now) noexcept override { clock_->sleep_until(now + Duration(1)); }

   private:
    VirtualClock* clock_;
  };
  VirtualClock sut;
  Sleeper sleeper(sut);
  sut.events().schedule_at(sleeper, at(1));
  EXPECT_DEATH(sut.sleep_until(at(2)), "broken invariant");
}

// A small random world: events that schedule and cancel each other.
class Chatter final : public Event {
 public:
  Chatter(VirtualClock& clock, std::mt19937& random, std::vector<std::unique_ptr<Chatter>>& all,
          TraceHash& trace)
      : clock_(&clock), random_(&random), all_(&all), trace_(&trace), id_(all.size()) {}
  void fire(MonotonicTime now) noexcept override {
    trace_->add(now.since_epoch.count());
    trace_->add(id_);
    Chatter& other = *(*all_)[(*random_)() % all_->size()];
    if ((*random_)() % 4 == 0) clock_->events().cancel(other);
    clock_->events().schedule_at(*this, now + Duration(1 + (*random_)() % 20));
  }

 private:
  VirtualClock* clock_;
  std::mt19937* random_;
  std::vector<std::unique_ptr<Chatter>>* all_;
  TraceHash* trace_;
  std::size_t id_;
};

std::uint64_t run_chatter(unsigned seed, std::int64_t slice_ns) {
  VirtualClock clock;
  std::mt19937 random(seed);
  TraceHash trace;
  std::vector<std::unique_ptr<Chatter>> all;
  for (int i = 0; i < 30; ++i) {
    all.push_back(std::make_unique<Chatter>(clock, random, all, trace));
    clock.events().schedule_at(*all.back(), at(1));
  }
  for (std::int64_t t = 0; t <= 5000; t += slice_ns) clock.sleep_until(at(t));
  return trace.value();
}

TEST(VirtualClock, SameSeedGivesTheSameTraceHoweverTheSleepIsCut) {
  EXPECT_EQ(run_chatter(1, 5000), run_chatter(1, 5000));
  EXPECT_EQ(run_chatter(1, 5000), run_chatter(1, 1));
  EXPECT_NE(run_chatter(1, 5000), run_chatter(2, 5000));
}

}  // namespace
}  // namespace thimble::sim
