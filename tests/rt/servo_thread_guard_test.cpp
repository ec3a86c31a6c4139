#include <gtest/gtest.h>

#include <boost/asio/ip/udp.hpp>
#include <cstdio>
#include <memory>
#include <mutex>
#include <ostream>
#include <shared_mutex>
#include <string>

#include "tests/rt/guarded_loop.hpp"
#include "tests/rt/thread_calls.hpp"
#include "tests/support/private_copy.hpp"

namespace thimble::test {

std::ostream& operator<<(std::ostream& out, const ThreadCalls& calls) {
  return out << calls.allocations << " allocations, " << calls.frees << " frees, " << calls.locks
             << " locks";
}

namespace {

constexpr int kTicks = 10000;
constexpr ThreadCalls kNothing{};

constexpr const char* kArm = R"(
[[arm]]
name = "right"
device = "sim:phantom-vintage"
amplifier_max_a = 3.0
activate = true
)";
constexpr const char* kHand = R"(
[arm.hand]
motion = "explore"
seed = 1
)";
constexpr const char* kBox = R"(
[[world]]
name = "box"
source = "box:3"
)";

std::string one_host(const std::string& more_of_arm = "") {
  return std::string(kArm) + "world = \"box\"\n" + kHand + more_of_arm + kBox;
}

// Arm and world of one process, but the datagrams between them cross the kernel.
std::string over_loopback() {
  boost::asio::io_context io;
  const boost::asio::ip::udp::socket probe(io, {boost::asio::ip::make_address_v4("127.0.0.1"), 0});
  const std::string address =
      "\"udp://127.0.0.1:" + std::to_string(probe.local_endpoint().port()) + "\"\n";
  return std::string(kArm) + "link = " + address + kHand + kBox + "listen = " + address;
}

class ServoThreadGuard : public ::testing::Test {
 protected:
  void SetUp() override {
    if (can_count_thread_calls()) return;
    GTEST_SKIP() << "a sanitizer has malloc and the locks for itself; counted in other builds";
  }

  static void expect_silent_contact(const std::string& config, Pace pace) {
    GuardedLoop sut(config, pace);
    ASSERT_TRUE(sut.is_made());
    EXPECT_EQ(sut.run(kTicks), kNothing);
    EXPECT_EQ(sut.snapshot().frame.state, OperatingState::Active);
    EXPECT_GT(sut.snapshot().total_contacts, 0U) << "the guard saw nothing of interest";
    EXPECT_GT(sut.snapshot().peak_force_newton, 0.0);
  }
};

TEST_F(ServoThreadGuard, ASessionAllocatesAndLocksNothingInVirtualTime) {
  expect_silent_contact(one_host(), Pace::Virtual);
}

TEST_F(ServoThreadGuard, NorBehindTheRealTimeBrake) {
  expect_silent_contact(one_host(), Pace::RealTimeBrake);
}

TEST_F(ServoThreadGuard, NorWithTheCallbackOfTheThesis) {
  expect_silent_contact(one_host("[arm.coupling]\nscheme = \"thesis-literal\"\n"), Pace::Virtual);
}

TEST_F(ServoThreadGuard, NorThroughAPluginAndItsSimulatedArm) {
  const testing_support::TemporaryFolder folder;
  const std::string plugin = testing_support::private_copy(folder, THIMBLE_SAMPLE_DRIVER);
  expect_silent_contact("[daemon]\nplugins = [\"" + plugin +
                            "\"]\n[[arm]]\nname = \"right\"\ndevice = \"sim:gantry\"\n"
                            "world = \"box\"\n" +
                            kHand + kBox,
                        Pace::Virtual);
}

TEST_F(ServoThreadGuard, NorOverAnImpairedLink) {
  expect_silent_contact(one_host("[arm.impairment]\ndelay_s = 0.02\njitter_s = 0.01\nloss = 0.05\n"
                                 "duplicate = 0.05\nreorder = 0.05\n"),
                        Pace::Virtual);
}

TEST_F(ServoThreadGuard, NorOverDatagrams) {
  GuardedLoop sut(over_loopback(), Pace::RealTimeBrake);
  ASSERT_TRUE(sut.is_made());
  EXPECT_EQ(sut.run(kTicks), kNothing);
  EXPECT_EQ(sut.snapshot().frame.state, OperatingState::Active);
  EXPECT_GT(sut.arm().link_status().counters.accepted, 0U);
}

TEST_F(ServoThreadGuard, NorInAReleaseAStopItsRecordingAndTheReturn) {
  GuardedLoop sut(one_host(), Pace::Virtual);
  ASSERT_TRUE(sut.is_made());
  EXPECT_EQ(sut.run(kTicks / 2), kNothing);
  sut.controls().want_active = false;
  EXPECT_EQ(sut.run(kTicks / 10), kNothing);
  EXPECT_EQ(sut.snapshot().frame.state, OperatingState::Inactive);
  sut.controls().want_active = true;
  EXPECT_EQ(sut.run(kTicks / 10), kNothing);
  EXPECT_EQ(sut.snapshot().frame.state, OperatingState::Active);

  sut.controls().is_estop_healthy = false;
  EXPECT_EQ(sut.run(kTicks / 10), kNothing);
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::Estop);
  sut.controls().is_estop_healthy = true;
  EXPECT_EQ(sut.run(1), kNothing);
  sut.controls().request_clear(sut.snapshot().fault.number);
  EXPECT_EQ(sut.run(kTicks / 2), kNothing);
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::None);
  EXPECT_EQ(sut.snapshot().frame.state, OperatingState::Active);
}

// Something in the simulated arm that does what it must not.
class PlantedBreach final : public sim::Event {
 public:
  enum class Kind { Allocation, Lock, Print };
  explicit PlantedBreach(Kind kind) : kind_(kind) {}
  void fire(MonotonicTime) noexcept override {
    if (kind_ == Kind::Lock) {
      const std::lock_guard lock(mutex_);
    }
    if (kind_ == Kind::Print) std::fputs("here", stdout);
    if (kind_ != Kind::Allocation) return;
    word_ = std::make_unique<std::string>("short");
    word_.reset();
  }

 private:
  Kind kind_;
  std::mutex mutex_;
  std::unique_ptr<std::string> word_;
};

// All that the process writes to its standard streams while `work` runs, buffered or not.
template <class Work>
std::string printed_by(Work work) {
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  work();
  return ::testing::internal::GetCapturedStdout() + ::testing::internal::GetCapturedStderr();
}

// The printed callback shared critical sections with the network and printed ten times a second.
using ThesisDefect = ServoThreadGuard;
TEST_F(ThesisDefect, TheServoWaitsForNoLockAndPrintsNothing) {
  GuardedLoop sut(over_loopback(), Pace::RealTimeBrake);
  ASSERT_TRUE(sut.is_made());
  ThreadCalls calls;
  EXPECT_EQ(printed_by([&] { calls = sut.run(kTicks); }), "");
  EXPECT_EQ(calls, kNothing);
  EXPECT_GT(sut.snapshot().total_contacts, 0U) << "the guard saw nothing of interest";
}

TEST_F(ServoThreadGuard, CatchesOneWordInTenThousandTicks) {
  GuardedLoop sut(one_host(), Pace::Virtual);
  ASSERT_TRUE(sut.is_made());
  PlantedBreach breach(PlantedBreach::Kind::Print);
  sut.arm().sim_arm()->clock().events().schedule_at(breach, MonotonicTime{std::chrono::seconds(7)});
  EXPECT_EQ(printed_by([&] { sut.run(kTicks); }), "here");
}

TEST_F(ServoThreadGuard, CatchesOneAllocationInTenThousandTicks) {
  GuardedLoop sut(one_host(), Pace::RealTimeBrake);
  ASSERT_TRUE(sut.is_made());
  PlantedBreach breach(PlantedBreach::Kind::Allocation);
  sut.arm().sim_arm()->clock().events().schedule_at(breach, MonotonicTime{std::chrono::seconds(7)});
  EXPECT_EQ(sut.run(kTicks), (ThreadCalls{.allocations = 1, .frees = 1, .locks = 0}));
}

TEST_F(ServoThreadGuard, CatchesOneLockInTenThousandTicks) {
  GuardedLoop sut(one_host(), Pace::RealTimeBrake);
  ASSERT_TRUE(sut.is_made());
  PlantedBreach breach(PlantedBreach::Kind::Lock);
  sut.arm().sim_arm()->clock().events().schedule_at(breach, MonotonicTime{std::chrono::seconds(7)});
  EXPECT_EQ(sut.run(kTicks), (ThreadCalls{.allocations = 0, .frees = 0, .locks = 1}));
}

TEST_F(ServoThreadGuard, CountsEveryWayToAllocateAndToLock) {
  const ThreadCalls before = thread_calls();
  void* volatile memory = std::malloc(1);
  memory = std::realloc(memory, 100);
  std::free(memory);
  memory = std::calloc(1, 1);
  std::free(memory);
  memory = std::aligned_alloc(64, 64);
  std::free(memory);
  memory = ::operator new (64, std::align_val_t{64});
  ::operator delete (memory, std::align_val_t{64});
  EXPECT_EQ(thread_calls() - before, (ThreadCalls{.allocations = 5, .frees = 4, .locks = 0}));

  std::shared_mutex mutex;
  const ThreadCalls unlocked = thread_calls();
  { const std::shared_lock reader(mutex); }
  { const std::unique_lock writer(mutex); }
  EXPECT_EQ((thread_calls() - unlocked).locks, 2U);
}

}  // namespace
}  // namespace thimble::test
