#include "hal/linux/wake_event.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace thimble::linux {
namespace {

constexpr Duration kNow{0};

TEST(WakeEvent, AWaitTakesAllSignalsBeforeItForOne) {
  const auto sut = WakeEvent::create().value();
  sut->signal();
  sut->signal();
  sut->wait();
  EXPECT_FALSE(sut->wait_at_most(kNow));
}

TEST(WakeEvent, AWaitWithAnEndSaysWhetherSomebodySignalled) {
  const auto sut = WakeEvent::create().value();
  EXPECT_FALSE(sut->wait_at_most(kNow));
  EXPECT_FALSE(sut->wait_at_most(Duration(1)));
  EXPECT_FALSE(sut->wait_at_most(Duration(-1))) << "below nothing is no wait without an end";
  sut->signal();
  EXPECT_TRUE(sut->wait_at_most(kNow));
  EXPECT_FALSE(sut->wait_at_most(kNow)) << "heard once";
}

TEST(WakeEvent, AThreadThatWaitsGoesOnAfterASignalOnly) {
  const auto sut = WakeEvent::create().value();
  std::atomic<bool> is_signalled{false};
  bool was_signalled_first = false;
  std::thread waiter([&] {
    sut->wait();
    was_signalled_first = is_signalled.load();
  });
  is_signalled.store(true);
  sut->signal();
  waiter.join();
  EXPECT_TRUE(was_signalled_first);
}

TEST(WakeEvent, NoSignalIsLostBetweenTwoThreads) {
  const auto there = WakeEvent::create().value();
  const auto back = WakeEvent::create().value();
  constexpr int kTurns = 1000;
  std::atomic<int> turns{0};
  std::thread other([&] {
    for (int i = 0; i < kTurns; ++i) {
      there->wait();
      turns.fetch_add(1);
      back->signal();
    }
  });
  for (int i = 0; i < kTurns; ++i) {
    there->signal();
    back->wait();
    ASSERT_EQ(turns.load(), i + 1);
  }
  other.join();
}

TEST(WakeEvent, WakesAThreadThatWaitsWithAnEnd) {
  const auto sut = WakeEvent::create().value();
  bool was_woken = false;
  std::thread waiter([&] { was_woken = sut->wait_at_most(std::chrono::minutes(5)); });
  sut->signal();
  waiter.join();
  EXPECT_TRUE(was_woken);
}

}  // namespace
}  // namespace thimble::linux
