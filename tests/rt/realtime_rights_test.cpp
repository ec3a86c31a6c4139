#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "hal/linux/cpu_dma_latency.hpp"
#include "hal/linux/memory_lock.hpp"
#include "hal/linux/realtime_process.hpp"
#include "hal/linux/realtime_thread.hpp"
#include "tests/rt/in_child_process.hpp"

namespace thimble::linux {
namespace {

using test::in_child_process;
using test::Rights;

#ifdef THIMBLE_UNDER_SANITIZER
constexpr bool kIsSanitized = true;  // sanitizers ignore mlockall() and enlarge stacks
#else
constexpr bool kIsSanitized = false;
#endif

std::string start_thread(const RealtimeThreadSettings& settings, const RealtimeReport& process) {
  bool has_run = false;
  auto thread = RealtimeThread::start(settings, process, [&] { has_run = true; });
  if (!thread.has_value()) return (has_run ? "RAN " : "") + thread.error().message;
  std::string answer;
  const RealtimeReport& report = thread.value()->report();
  for (const std::string& entry : report.missing) answer += entry + "\n";
  if (report.has_fifo) answer += "has fifo\n";
  thread.value().reset();
  return answer + (has_run ? "ran" : "did not run");
}

std::size_t status_kb(const std::string& key) {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word) {
    if (word != key + ":") continue;
    std::size_t value = 0;
    status >> value;
    return value;
  }
  return 0;
}

TEST(RealtimeThread, RunsTheBodyOnceAndJoins) {
  int runs = 0;
  {
    auto sut = RealtimeThread::start({.name = "servo"}, {}, [&] { ++runs; });
    ASSERT_TRUE(sut.has_value());
  }
  EXPECT_EQ(runs, 1);
}

TEST(RealtimeThread, ReportsThePriorityThatItReallyHas) {
  int policy = -1;
  sched_param parameters{};
  auto sut = RealtimeThread::start({.name = "servo", .priority = 7}, {}, [&] {
    ::pthread_getschedparam(::pthread_self(), &policy, &parameters);
  });
  ASSERT_TRUE(sut.has_value());
  const bool has_fifo = sut.value()->report().has_fifo;
  const bool is_missing = sut.value()->report().is_degraded();
  sut.value().reset();

  EXPECT_EQ(policy, has_fifo ? SCHED_FIFO : SCHED_OTHER);
  EXPECT_EQ(is_missing, !has_fifo);
  EXPECT_EQ(parameters.sched_priority, has_fifo ? 7 : 0);
}

TEST(RealtimeThread, HasItsNameItsStackAndNoSignals) {
  char name[16] = {};
  std::size_t stack_bytes = 0;
  sigset_t blocked;
  ::sigemptyset(&blocked);
  auto sut = RealtimeThread::start({.name = "a-name-beyond-the-limit"}, {}, [&] {
    ::pthread_getname_np(::pthread_self(), name, sizeof(name));
    pthread_attr_t attributes;
    ::pthread_getattr_np(::pthread_self(), &attributes);
    ::pthread_attr_getstacksize(&attributes, &stack_bytes);
    ::pthread_attr_destroy(&attributes);
    ::pthread_sigmask(SIG_SETMASK, nullptr, &blocked);
  });
  sut.value().reset();

  EXPECT_STREQ(name, "a-name-beyond-t");
  if (!kIsSanitized) {
    EXPECT_EQ(stack_bytes, kThreadStackBytes);
  }
  EXPECT_TRUE(::sigismember(&blocked, SIGTERM));
  sigset_t mine;
  ::pthread_sigmask(SIG_SETMASK, nullptr, &mine);
  EXPECT_FALSE(::sigismember(&mine, SIGTERM)) << "the caller's mask is restored";
}

TEST(RealtimeThread, PinsToTheCpu) {
  cpu_set_t allowed;
  ASSERT_EQ(::sched_getaffinity(0, sizeof(allowed), &allowed), 0);
  unsigned cpu = 0;
  while (!CPU_ISSET(cpu, &allowed)) ++cpu;
  cpu_set_t seen;
  auto sut = RealtimeThread::start({.name = "servo", .cpu = cpu}, {}, [&] {
    ::pthread_getaffinity_np(::pthread_self(), sizeof(seen), &seen);
  });
  EXPECT_TRUE(sut.value()->report().has_affinity);
  sut.value().reset();
  EXPECT_EQ(CPU_COUNT(&seen), 1);
  EXPECT_TRUE(CPU_ISSET(cpu, &seen));
}

TEST(RealtimeThread, ACpuThatIsNotThereIsNamed) {
  for (const unsigned cpu : {1000U, 100000U}) {
    const std::string answer = start_thread({.name = "servo", .cpu = cpu}, {});
    EXPECT_NE(answer.find("CPU " + std::to_string(cpu) + " refused"), std::string::npos) << answer;
    EXPECT_NE(answer.find("\nran"), std::string::npos) << answer;
  }
}

TEST(RealtimeThread, FlushesDenormals) {
#if defined(__SSE2__)
  volatile double smallest = 2.2250738585072014e-308;  // DBL_MIN
  double half = -1;
  {
    auto sut = RealtimeThread::start({.name = "servo"}, {}, [&] { half = smallest / 2; });
  }
  EXPECT_EQ(half, 0.0);
  EXPECT_GT(smallest / 2, 0.0) << "only that thread";
#else
  GTEST_SKIP() << "x86 only";
#endif
}

TEST(RealtimeThread, RefusesAPriorityOutOfRange) {
  for (const int priority : {0, -1, 99, 100}) {
    const auto sut = RealtimeThread::start({.name = "servo", .priority = priority}, {}, [] {});
    ASSERT_FALSE(sut.has_value()) << priority;
    EXPECT_EQ(sut.error().code, Errc::InvalidArgument);
  }
}

TEST(RealtimeThread, BestEffortRunsWithoutRightsAndNamesTheMissingOne) {
  const std::string answer = in_child_process(
      Rights::None, [] { return start_thread({.name = "servo", .priority = 80}, {}); });
  EXPECT_NE(answer.find("SCHED_FIFO priority 80 refused"), std::string::npos) << answer;
  EXPECT_NE(answer.find("RLIMIT_RTPRIO >= 80 (now 0) or CAP_SYS_NICE"), std::string::npos);
  EXPECT_NE(answer.find("LimitRTPRIO=80"), std::string::npos);
  EXPECT_NE(answer.find("\nran"), std::string::npos) << answer;
}

TEST(RealtimeThread, RequiredFailsWithEverythingThatIsMissingAndNeverRuns) {
  const std::string answer = in_child_process(Rights::None, [] {
    const RealtimeProcess process;
    return start_thread({.name = "servo", .policy = RealtimePolicy::Required, .cpu = 1000U},
                        process.report());
  });
  EXPECT_EQ(answer.find("real time is required, but:"), 0U) << answer;
  EXPECT_NE(answer.find("LimitRTPRIO=80"), std::string::npos) << answer;
  EXPECT_NE(answer.find("CPU 1000 refused"), std::string::npos) << answer;
  EXPECT_NE(answer.find("LimitMEMLOCK=infinity"), std::string::npos) << answer;
  EXPECT_NE(answer.find("/dev/cpu_dma_latency"), std::string::npos) << answer;
}

TEST(RealtimeReport, RequiredIsContentWhenNothingIsMissing) {
  EXPECT_TRUE(enforce(RealtimePolicy::Required, {}).has_value());
  RealtimeReport report;
  report.missing.emplace_back("something");
  EXPECT_TRUE(enforce(RealtimePolicy::BestEffort, report).has_value());
  EXPECT_EQ(enforce(RealtimePolicy::Required, report).error().code, Errc::Permission);
}

TEST(LockMemory, AFiniteLimitIsRefusedBeforeAnythingIsLocked) {
  const std::string answer = in_child_process(Rights::None, [] {
    const Result<void> result = lock_memory();
    if (result.has_value()) return std::string("locked");
    return std::string(to_string(result.error().code)) + " " + std::to_string(status_kb("VmLck"));
  });
  EXPECT_EQ(answer, "permission 0");
}

TEST(LockMemory, LocksEverythingAndStaysSmallWithFiveThreads) {
  if (kIsSanitized) GTEST_SKIP() << "a sanitizer's shadow cannot be locked";
  const std::string answer = in_child_process(Rights::AsTheTest, [] {
    const RealtimeProcess process;
    if (!process.report().has_memory_lock) return process.report().missing.front();
    std::vector<std::thread> threads;
    for (int i = 0; i < 5; ++i) threads.emplace_back([] { std::free(std::malloc(1000)); });
    const std::size_t resident_kb = status_kb("VmRSS");
    for (std::thread& thread : threads) thread.join();
    if (status_kb("VmLck") == 0) return std::string("nothing locked");
    return std::string(resident_kb < 40 * 1024 ? "small" : "big: ") + std::to_string(resident_kb);
  });
  if (answer.find("LimitMEMLOCK") != std::string::npos) GTEST_SKIP() << answer;
  EXPECT_EQ(answer.substr(0, 5), "small") << answer;
  RecordProperty("resident_kb", answer.substr(5));
}

TEST(RealtimeProcess, HasNoHugePagesMadeOfItsMemoryWithoutRightsEither) {
  const std::string answer = in_child_process(Rights::None, [] {
    const int before = ::prctl(PR_GET_THP_DISABLE, 0, 0, 0, 0);
    const RealtimeProcess process;
    return std::to_string(before) + " " + std::to_string(::prctl(PR_GET_THP_DISABLE, 0, 0, 0, 0));
  });
  EXPECT_EQ(answer, "0 1");
}

TEST(DefaultThreadStack, AppliesToThreadsMadeLater) {
  const std::string answer = in_child_process(Rights::AsTheTest, [] {
    if (!set_default_thread_stack(kThreadStackBytes).has_value()) return std::string("refused");
    std::size_t bytes = 0;
    std::thread([&] {
      pthread_attr_t attributes;
      ::pthread_getattr_np(::pthread_self(), &attributes);
      ::pthread_attr_getstacksize(&attributes, &bytes);
      ::pthread_attr_destroy(&attributes);
    }).join();
    return std::to_string(bytes);
  });
  if (!kIsSanitized) {
    EXPECT_EQ(answer, std::to_string(kThreadStackBytes));
  }
  EXPECT_EQ(set_default_thread_stack(1).error().code, Errc::InvalidArgument);
}

TEST(CpuDmaLatency, ARefusalNamesTheNodeAndTheCure) {
  const auto absent = CpuDmaLatency::hold("/nonexistent/cpu_dma_latency");
  ASSERT_FALSE(absent.has_value());
  EXPECT_EQ(absent.error().code, Errc::NotFound);
  EXPECT_NE(absent.error().message.find("/nonexistent/cpu_dma_latency"), std::string::npos);
  EXPECT_NE(absent.error().message.find("DeviceAllow="), std::string::npos);
}

TEST(CpuDmaLatency, WritesABinaryZeroAndHoldsTheNodeOpen) {
  char path[] = "/tmp/thimble-latency-XXXXXX";
  const int file = ::mkstemp(path);
  ASSERT_GE(file, 0);
  {
    const auto sut = CpuDmaLatency::hold(path);
    ASSERT_TRUE(sut.has_value());
    char content[8] = {1, 1, 1, 1, 1, 1, 1, 1};
    EXPECT_EQ(::pread(file, content, sizeof(content), 0), 4);
    EXPECT_EQ(std::count(content, content + 4, 0), 4);
  }
  ::close(file);
  ::unlink(path);
}

}  // namespace
}  // namespace thimble::linux
