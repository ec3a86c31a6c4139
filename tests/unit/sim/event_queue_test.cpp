#include "sim/time/event_queue.hpp"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "sim/time/scheduled_calls.hpp"
#include "sim/time/virtual_clock.hpp"

namespace thimble::sim {
namespace {

constexpr MonotonicTime at(std::int64_t ns) { return {Duration(ns)}; }

class NumberedEvent final : public Event {
 public:
  void fire(MonotonicTime) noexcept override {}
};

TEST(EventQueue, TakesEventsByTimeThenByOrderOfScheduling) {
  EventQueue sut;
  std::array<NumberedEvent, 4> events;
  sut.schedule_at(events[0], at(20));
  sut.schedule_at(events[1], at(10));
  sut.schedule_at(events[2], at(20));
  sut.schedule_at(events[3], at(10));

  std::vector<Event*> taken;
  MonotonicTime due{};
  while (Event* event = sut.take_due(at(20), due)) taken.push_back(event);

  EXPECT_EQ(taken, (std::vector<Event*>{&events[1], &events[3], &events[0], &events[2]}));
}

TEST(EventQueue, KeepsWhatIsDueAfterTheLimit) {
  EventQueue sut;
  NumberedEvent event;
  sut.schedule_at(event, at(11));
  MonotonicTime due{};

  EXPECT_EQ(sut.take_due(at(10), due), nullptr);
  EXPECT_TRUE(event.is_scheduled());
  EXPECT_EQ(sut.take_due(at(11), due), &event);
  EXPECT_EQ(due, at(11));
  EXPECT_FALSE(event.is_scheduled());
}

TEST(EventQueue, ADestroyedEventIsTakenOff) {
  EventQueue sut;
  NumberedEvent kept;
  {
    NumberedEvent destroyed;
    sut.schedule_at(destroyed, at(1));
    sut.schedule_at(kept, at(2));
  }
  MonotonicTime due{};
  EXPECT_EQ(sut.take_due(at(5), due), &kept);
  EXPECT_EQ(sut.size(), 0U);
}

TEST(EventQueue, AnEventMayOutliveTheQueue) {
  NumberedEvent event;
  {
    EventQueue sut;
    sut.schedule_at(event, at(1));
  }
  EXPECT_FALSE(event.is_scheduled());
}

TEST(EventQueue, AnEventOfAnotherQueueIsNotCancelled) {
  EventQueue sut;
  EventQueue other;
  NumberedEvent event;
  other.schedule_at(event, at(1));

  EXPECT_FALSE(sut.cancel(event));
  EXPECT_TRUE(event.is_scheduled());
  sut.schedule_at(event, at(2));
  EXPECT_EQ(other.size(), 0U) << "scheduling elsewhere moves it";
}

// Random programs against a sorted map as the oracle.
TEST(EventQueue, BehavesLikeASortedMap) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    EventQueue sut;
    std::array<NumberedEvent, 40> events;
    std::map<std::pair<std::int64_t, std::uint64_t>, Event*> oracle;
    std::uint64_t sequence = 0;
    const auto forget = [&](Event* event) {
      return std::erase_if(oracle, [&](const auto& entry) { return entry.second == event; }) != 0;
    };
    for (int step = 0; step < 3000; ++step) {
      NumberedEvent& event = events[random() % events.size()];
      const auto time = static_cast<std::int64_t>(random() % 50);
      switch (random() % 3) {
        case 0:
          forget(&event);
          sut.schedule_at(event, at(time));
          oracle[{time, sequence++}] = &event;
          break;
        case 1:
          ASSERT_EQ(sut.cancel(event), forget(&event));
          break;
        default: {
          MonotonicTime due{};
          Event* expected = nullptr;
          if (!oracle.empty() && oracle.begin()->first.first <= time) {
            expected = oracle.begin()->second;
            oracle.erase(oracle.begin());
          }
          ASSERT_EQ(sut.take_due(at(time), due), expected) << "seed " << seed << " step " << step;
        }
      }
      ASSERT_EQ(sut.size(), oracle.size());
    }
  }
}

TEST(ScheduledCalls, RunOnceInOrderUnlessCancelled) {
  VirtualClock clock;
  ScheduledCalls sut(clock.events());
  std::vector<int> calls;
  sut.schedule_at(at(2), [&](MonotonicTime) { calls.push_back(2); });
  const auto cancelled = sut.schedule_at(at(1), [&](MonotonicTime) { calls.push_back(-1); });
  const auto made = sut.schedule_at(at(1), [&](MonotonicTime now) {
    calls.push_back(1);
    sut.schedule_at(now + Duration(2), [&](MonotonicTime t) {
      calls.push_back(static_cast<int>(t.since_epoch.count()));
    });
  });

  EXPECT_TRUE(sut.cancel(cancelled));
  EXPECT_FALSE(sut.cancel(cancelled));
  clock.run_for(Duration(10));

  EXPECT_EQ(calls, (std::vector<int>{1, 2, 3}));
  EXPECT_FALSE(sut.cancel(made));
}

TEST(ScheduledCalls, DestructionCancelsWhatIsPending) {
  VirtualClock clock;
  int calls = 0;
  {
    ScheduledCalls sut(clock.events());
    sut.schedule_at(at(1), [&](MonotonicTime) { ++calls; });
  }
  clock.run_for(Duration(10));
  EXPECT_EQ(calls, 0);
}

}  // namespace
}  // namespace thimble::sim
