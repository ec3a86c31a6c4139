#include "hal/rt/inheriting_mutex.hpp"

#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <mutex>
#include <string>
#include <thread>

#include "hal/linux/realtime_thread.hpp"
#include "tests/rt/wait_until.hpp"

namespace thimble::rt {
namespace {

// proc(5), field 18 of stat: of a thread with a real-time priority, minus that and 1.
int urgency_of_this_thread() {
  std::ifstream file("/proc/self/task/" + std::to_string(::syscall(SYS_gettid)) + "/stat");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  std::size_t at = text.rfind(')') + 2;  // field 3
  for (int field = 3; field < 18; ++field) at = text.find(' ', at) + 1;
  return -std::stoi(text.substr(at)) - 1;
}

TEST(InheritingMutex, KeepsTwoApart) {
  InheritingMutex sut;
  int count = 0;
  const auto add = [&] {
    for (int i = 0; i < 10'000; ++i) {
      const std::lock_guard guard(sut);
      count = count + 1;
    }
  };
  std::thread other(add);
  add();
  other.join();
  EXPECT_EQ(count, 20'000);
}

TEST(InheritingMutex, IsTriedInVainWhileAnotherHasIt) {
  InheritingMutex sut;
  const std::lock_guard guard(sut);
  bool is_had = true;
  std::thread([&] { is_had = sut.try_lock(); }).join();
  EXPECT_FALSE(is_had);
}

TEST(InheritingMutex, WhoHoldsItIsAsUrgentAsWhoWaits) {
  constexpr int kUrgent = 37;
  InheritingMutex sut;
  sut.lock();
  auto waits = linux::RealtimeThread::start({.name = "waits", .priority = kUrgent}, {}, [&] {
    sut.lock();
    sut.unlock();
  });
  ASSERT_TRUE(waits);
  const bool has_fifo = (*waits)->report().has_fifo;
  const bool is_raised =
      has_fifo && test::wait_until([] { return urgency_of_this_thread() == kUrgent; });
  sut.unlock();
  waits->reset();
  if (!has_fifo) GTEST_SKIP() << "no thread may be urgent here";
  EXPECT_TRUE(is_raised);
  EXPECT_LT(urgency_of_this_thread(), 0) << "with the lock it gives that back";
}

}  // namespace
}  // namespace thimble::rt
