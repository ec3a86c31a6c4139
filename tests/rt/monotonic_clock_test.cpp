#include "hal/linux/monotonic_clock.hpp"

#include <gtest/gtest.h>
#include <pthread.h>
#include <signal.h>

#include <atomic>
#include <thread>

namespace thimble::linux {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

std::atomic<int> signals{0};

TEST(MonotonicClock, NeverRunsBackwards) {
  const MonotonicClock sut;
  MonotonicTime last = sut.now();
  for (int i = 0; i < 100000; ++i) {
    const MonotonicTime now = sut.now();
    ASSERT_GE(now, last);
    last = now;
  }
  EXPECT_GT(last.since_epoch, Duration(0));
}

TEST(MonotonicClock, WakesAtTheDeadlineOrLaterAndSaysHowMuch) {
  MonotonicClock sut;
  for (int i = 0; i < 20; ++i) {
    const MonotonicTime deadline = sut.now() + milliseconds(1);
    const Duration lateness = sut.sleep_until(deadline);
    const MonotonicTime after = sut.now();
    ASSERT_GE(after, deadline);
    ASSERT_GE(lateness, Duration(0));
    ASSERT_LE(lateness, after - deadline);
  }
}

TEST(MonotonicClock, ADeadlineInThePastReturnsHowLongAgoItWas) {
  MonotonicClock sut;
  EXPECT_GE(sut.sleep_until(sut.now() - seconds(5)), seconds(5));
  EXPECT_GE(sut.sleep_until(MonotonicTime{Duration(-1)}), sut.now().since_epoch - seconds(60));
}

TEST(MonotonicClock, ASignalDoesNotEndTheSleepEarly) {
  struct sigaction action {};
  action.sa_handler = [](int) { signals.fetch_add(1); };
  struct sigaction previous {};
  ASSERT_EQ(::sigaction(SIGUSR1, &action, &previous), 0);
  MonotonicClock sut;
  const MonotonicTime deadline = sut.now() + milliseconds(50);
  const pthread_t sleeper = ::pthread_self();
  std::thread disturber([&] {
    MonotonicClock clock;
    while (clock.now() < deadline) {
      ::pthread_kill(sleeper, SIGUSR1);
      clock.sleep_until(clock.now() + milliseconds(2));
    }
  });

  sut.sleep_until(deadline);
  EXPECT_GE(sut.now(), deadline);

  disturber.join();
  EXPECT_GT(signals.load(), 0);
  ::sigaction(SIGUSR1, &previous, nullptr);
}

}  // namespace
}  // namespace thimble::linux
