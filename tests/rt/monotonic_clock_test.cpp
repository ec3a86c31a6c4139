#include "hal/linux/monotonic_clock.hpp"

#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>

#include <atomic>
#include <fstream>
#include <string>
#include <thread>

#include "tests/rt/in_child_process.hpp"

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

// A suspended machine is one whose boot-time clock ran on and whose CLOCK_MONOTONIC did not: so it
// is in a time namespace that shifts the former alone, for whoever is born in it.
std::string seconds_after_a_suspension(int suspended_s) {
  // Whoever may do the former needs no user namespace, which takes a process of one thread.
  const bool has_one =
      ::unshare(CLONE_NEWTIME) == 0 || ::unshare(CLONE_NEWUSER | CLONE_NEWTIME) == 0;
  if (!has_one) return "no time namespace";
  std::ofstream offsets("/proc/self/timens_offsets");
  offsets << "boottime " << suspended_s << " 0\n";
  if (!offsets.flush()) return "no offset";
  return test::in_child_process(test::Rights::AsTheTest, [] {
    MonotonicClock sut;
    const MonotonicTime start = sut.now();
    sut.sleep_until(start + milliseconds(1));
    if (sut.now() - start > seconds(30)) return std::string("slept by another clock");
    return std::to_string(std::chrono::duration_cast<seconds>(start.since_epoch).count());
  });
}

TEST(MonotonicClock, TimeInWhichTheMachineIsSuspendedPasses) {
  constexpr int kSuspended_s = 100'000;
  const MonotonicClock sut;
  const seconds before = std::chrono::duration_cast<seconds>(sut.now().since_epoch);
  const std::string after = test::in_child_process(
      test::Rights::AsTheTest, [] { return seconds_after_a_suspension(kSuspended_s); });
  ASSERT_NE(after.find_first_of("0123456789"), std::string::npos) << after;
  EXPECT_GE(std::stoll(after), before.count() + kSuspended_s);
}

}  // namespace
}  // namespace thimble::linux
