#include "guard/guard_session.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <span>
#include <string>
#include <utility>

#include "hal/linux/monotonic_clock.hpp"
#include "sim/time/virtual_clock.hpp"
#include "tests/support/fake_hid_kernel.hpp"

// A guard on a pipe instead of an arm, in hand-moved time.
namespace thimble::guard {
namespace {

using linux::Descriptor;

using std::chrono::milliseconds;

class Rig {
 public:
  Rig() {
    std::array<int, 2> ends{};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()), 0);
    daemon = Descriptor(ends[0]);
    guard_ = Descriptor(ends[1]);
    EXPECT_EQ(::pipe2(ends.data(), O_CLOEXEC | O_NONBLOCK), 0);
    arm_ = Descriptor(ends[0]);
    node_ = Descriptor(ends[1]);
  }
  Result<GuardSession> accept() { return accept(ZeroRoute::Write, kernel_); }
  Result<GuardSession> accept(ZeroRoute route, linux::DeviceCalls& calls) {
    page.heartbeat().drive = 1;
    const Handover handover{route, 0, 3, {0, 7, 9}};
    EXPECT_TRUE(send_handover(daemon.get(), handover, node_.get(), page.descriptor()).has_value());
    return GuardSession::accept(guard_.get(), 1000, calls);
  }
  // Looks for `ms` at a servo that beats or does not; how often the arm was given zero meanwhile.
  int run(GuardSession& guard, int ms, bool is_alive) {
    for (int i = 0; i < ms; i += 2) {
      clock.run_for(milliseconds(2));
      if (is_alive) page.heartbeat().beat(clock.now());
      is_over = !guard.step(clock);
      if (is_over) break;
    }
    return zeros();
  }
  int zeros() {
    int count = 0;
    std::array<char, 3> report{};
    while (::read(arm_.get(), report.data(), report.size()) == 3) {
      EXPECT_EQ(report, (std::array<char, 3>{0, 7, 9}));
      ++count;
    }
    return count;
  }

  Descriptor daemon;
  SharedPage page{std::move(SharedPage::create().value())};
  sim::VirtualClock clock;
  bool is_over{false};

 private:
  Descriptor guard_;
  Descriptor arm_;
  Descriptor node_;
  linux::KernelCalls kernel_;
};

TEST(GuardSession, AnswersThatItWatches) {
  Rig rig;
  ASSERT_TRUE(rig.accept().has_value());
  char answer = 0;
  ASSERT_EQ(::recv(rig.daemon.get(), &answer, 1, 0), 1);
  EXPECT_EQ(answer, kWatching);
}

TEST(GuardSession, LetsTheArmGoWhenTheBeatsStopAndTellsTheServo) {
  Rig rig;
  auto guard = rig.accept();
  EXPECT_EQ(rig.run(*guard, 1000, true), 0);
  EXPECT_EQ(rig.run(*guard, 20, false), 0);
  EXPECT_EQ(rig.page.heartbeat().interventions.load(), 0U);
  EXPECT_EQ(rig.run(*guard, 1000, false), 51);
  EXPECT_EQ(rig.page.heartbeat().interventions.load(), 1U);
  EXPECT_EQ(rig.run(*guard, 100, true), 50) << "until the servo took the force away";
  rig.page.heartbeat().drive = 0;
  EXPECT_EQ(rig.run(*guard, 100, true), 0);
}

TEST(GuardSession, LetsTheArmGoAndEndsWhenTheDaemonIsGone) {
  Rig rig;
  auto guard = rig.accept();
  EXPECT_EQ(rig.run(*guard, 10, true), 0);
  rig.daemon = Descriptor();
  EXPECT_EQ(rig.run(*guard, 1000, false), 51);
  EXPECT_TRUE(rig.is_over);
}

TEST(GuardSession, OfADaemonThatIsGoneAndDidNotDriveLeavesTheArmAlone) {
  Rig rig;
  auto guard = rig.accept();
  rig.page.heartbeat().drive = 0;
  rig.run(*guard, 10, true);
  rig.daemon = Descriptor();
  EXPECT_EQ(rig.run(*guard, 1000, false), 0);
  EXPECT_TRUE(rig.is_over);
}

TEST(GuardSession, BelievesWhatTheDaemonSaidLastWhenItIsGone) {
  Rig rig;
  auto guard = rig.accept();
  rig.page.heartbeat().drive = 0;
  rig.run(*guard, 10, true);
  rig.page.heartbeat().drive = 1;  // and wrote a force, and died between two looks
  rig.daemon = Descriptor();
  EXPECT_EQ(rig.run(*guard, 1000, false), 51);
}

TEST(GuardSession, TakesAPeerThatTalksForTheEndOfIt) {
  Rig rig;
  auto guard = rig.accept();
  rig.run(*guard, 10, true);
  ASSERT_EQ(::send(rig.daemon.get(), "x", 1, 0), 1);
  EXPECT_EQ(rig.run(*guard, 1000, true), 51);
  EXPECT_TRUE(rig.is_over);
}

// An arm that was unplugged and returned has a new guard, but its servo is the same.
TEST(GuardSession, CountsOnWhereTheGuardBeforeItEnded) {
  Rig rig;
  rig.page.heartbeat().interventions = 5;
  auto guard = rig.accept();
  EXPECT_EQ(rig.run(*guard, 100, true), 0);
  EXPECT_EQ(rig.run(*guard, 50, false), 15);
  EXPECT_EQ(rig.page.heartbeat().interventions.load(), 6U);
  rig.page.heartbeat().drive = 0;
  EXPECT_EQ(rig.run(*guard, 100, true), 0);
}

TEST(GuardSession, OfAnArmThatIsGoneGoesOnAndCountsWhatWasRefused) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()), 0);
  const Descriptor daemon(ends[0]);
  const Descriptor guard(ends[1]);
  SharedPage page = std::move(SharedPage::create().value());
  const Descriptor null(::open("/dev/null", O_RDONLY | O_CLOEXEC));
  linux::KernelCalls kernel;
  for (const ZeroRoute route : {ZeroRoute::Write, ZeroRoute::UsbBulk, ZeroRoute::Hiddev}) {
    ASSERT_TRUE(
        send_handover(daemon.get(), {route, 2, 16, {}}, null.get(), page.descriptor()).has_value());
    auto session = GuardSession::accept(guard.get(), 1000, kernel);
    ASSERT_TRUE(session.has_value());
    page.heartbeat().drive = 1;
    sim::VirtualClock clock;
    page.heartbeat().beat(clock.now());
    EXPECT_TRUE(session->step(clock));
    clock.run_for(milliseconds(28));
    EXPECT_TRUE(session->step(clock));
    EXPECT_EQ(session->zeros().refused(), 1U);
    EXPECT_EQ(session->zeros().written(), 0U);
  }
}

TEST(GuardSession, ADaemonThatEndsIsNotWaitedFor) {
  Rig rig;
  auto guard = rig.accept();
  rig.run(*guard, 10, true);
  // As it sees them, the last beat is too old in an hour: only the end itself can wake it.
  rig.clock.run_for(std::chrono::hours(1));
  rig.page.heartbeat().beat(rig.clock.now());
  EXPECT_TRUE(guard->step(rig.clock));
  rig.daemon = Descriptor();
  sim::VirtualClock an_hour_ago;
  guard->await_next(an_hour_ago);
  EXPECT_TRUE(guard->step(rig.clock));
  EXPECT_EQ(rig.zeros(), 1);
  int zeros = 1;
  while (guard->step(rig.clock)) {
    guard->await_next(rig.clock);
    zeros += rig.zeros();
  }
  EXPECT_EQ(zeros, 52) << "the first two at one time, and then one each 2 ms";
}

TEST(GuardSession, WaitsForItsNextLookWhileNobodyEnds) {
  Rig rig;
  auto guard = rig.accept();
  linux::MonotonicClock clock;
  const MonotonicTime beat_at = clock.now();
  rig.page.heartbeat().beat(beat_at);
  EXPECT_TRUE(guard->step(clock));
  guard->await_next(clock);
  EXPECT_GE(clock.now() - beat_at, milliseconds(19));
}

using Report = test::FakeHidKernel::Report;
const Report kZeroByHiddev{"dev", {0, 7, 9}};

TEST(GuardSession, AnArmThatIsDrivenOverHiddevIsLetGoOverThatAlone) {
  Rig rig;
  test::FakeHidKernel kernel;
  kernel.fields = {{3}};
  auto guard = rig.accept(ZeroRoute::Hiddev, kernel);
  rig.run(*guard, 100, true);
  EXPECT_TRUE(kernel.sent.empty());
  rig.run(*guard, 1000, false);
  EXPECT_EQ(kernel.sent, std::vector<Report>(51, kZeroByHiddev));
}

// The arm takes nothing for a while: the one zero that waited is not the last.
TEST(GuardSession, WhereAWriteHangsZeroFollowsForAsLongAsEver) {
  Rig rig;
  test::FakeHidKernel kernel;
  kernel.fields = {{3}};
  auto guard = rig.accept(ZeroRoute::Hiddev, kernel);
  rig.run(*guard, 100, true);
  int writes = 0;
  kernel.on_send = [&] {
    if (writes++ == 0) rig.clock.run_for(std::chrono::seconds(5));
  };
  rig.run(*guard, 22, false);
  ASSERT_EQ(writes, 1) << "it hung 5 s";
  rig.run(*guard, 1000, false);
  EXPECT_EQ(writes, 51) << "50 looks in the 100 ms after it";
}

TEST(GuardSession, OfAnArmThatLeftWithItsDaemonEndsWithTheFirstZeroThatIsRefused) {
  for (const ZeroRoute route : {ZeroRoute::Write, ZeroRoute::Hiddev}) {
    Rig rig;
    test::FakeHidKernel kernel;
    kernel.fields = {{3}};
    auto guard = rig.accept(route, kernel);
    rig.run(*guard, 100, true);
    kernel.is_unplugged = true;
    kernel.has_unread_events = route == ZeroRoute::Hiddev;
    rig.run(*guard, 1000, false);
    EXPECT_FALSE(rig.is_over) << "its daemon may have more to say";
    const std::uint64_t refused = guard->zeros().refused();
    EXPECT_GT(refused, 400U);
    rig.daemon = Descriptor();
    rig.run(*guard, 1000, false);
    EXPECT_TRUE(rig.is_over);
    EXPECT_EQ(guard->zeros().refused(), refused + 1);
    EXPECT_EQ(guard->zeros().written(), 0U);
  }
}

// A kernel that refuses every zero by the same word.
struct RefusingKernel final : linux::DeviceCalls {
  std::ptrdiff_t write(int, std::span<const std::uint8_t>) noexcept override { return refuse(); }
  int control(int, unsigned long, void*) noexcept override { return refuse(); }
  bool is_gone(int) noexcept override { return is_node_gone; }
  int refuse() noexcept {
    errno = by;
    return -1;
  }
  int by{0};
  bool is_node_gone{false};
};

// ENODEV of usbfs is said of a device that is being reset, too, whose zero must be tried on.
TEST(GuardSession, OneThatRefusesAndIsThereIsAskedFor25SecondsMore) {
  using Refusal = std::pair<ZeroRoute, int>;
  for (const auto& [route, by] :
       {Refusal{ZeroRoute::UsbBulk, ENODEV}, Refusal{ZeroRoute::UsbBulk, ETIMEDOUT},
        Refusal{ZeroRoute::UsbBulk, EPIPE}, Refusal{ZeroRoute::Write, EIO},
        Refusal{ZeroRoute::Write, ENODEV}, Refusal{ZeroRoute::Hiddev, EINVAL}}) {
    Rig rig;
    RefusingKernel kernel;
    kernel.by = by;
    auto guard = rig.accept(route, kernel);
    rig.run(*guard, 100, true);
    rig.daemon = Descriptor();
    rig.run(*guard, 24'900, false);
    EXPECT_FALSE(rig.is_over) << by;
    rig.run(*guard, 200, false);
    EXPECT_TRUE(rig.is_over) << by;
  }
}

TEST(GuardSession, OneOfWhichTheNodeSaysThatItLeftIsAskedOnceWhateverItSays) {
  for (const ZeroRoute route : {ZeroRoute::UsbBulk, ZeroRoute::Write}) {
    Rig rig;
    RefusingKernel kernel;
    kernel.by = EIO;
    kernel.is_node_gone = true;
    auto guard = rig.accept(route, kernel);
    rig.run(*guard, 10, true);
    rig.daemon = Descriptor();
    rig.run(*guard, 1000, false);
    EXPECT_TRUE(rig.is_over);
    EXPECT_EQ(guard->zeros().refused(), 1U);
  }
}

TEST(KernelCalls, ANodeIsGoneWhenItsOtherEndIsAndNotBefore) {
  Descriptor device(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC));
  ASSERT_TRUE(device.get() >= 0 && ::grantpt(device.get()) == 0 && ::unlockpt(device.get()) == 0);
  std::array<char, 64> name{};
  ASSERT_EQ(::ptsname_r(device.get(), name.data(), name.size()), 0);
  const Descriptor node(::open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK));
  ASSERT_GE(node.get(), 0);
  linux::KernelCalls sut;
  EXPECT_FALSE(sut.is_gone(node.get()));
  device = Descriptor();
  EXPECT_TRUE(sut.is_gone(node.get()));
  EXPECT_FALSE(sut.is_gone(-1)) << "nobody knows of one that was never there";
}

TEST(SharedPage, OfAnotherProcessMustNotBeAbleToShrink) {
  EXPECT_FALSE(SharedPage::map(Descriptor(::open("/dev/null", O_RDWR | O_CLOEXEC))).has_value());
  Descriptor unsealed(::memfd_create("unsealed", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  ASSERT_EQ(::ftruncate(unsealed.get(), 4096), 0);
  EXPECT_FALSE(SharedPage::map(std::move(unsealed)).has_value());
  Descriptor tiny(::memfd_create("tiny", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  ASSERT_EQ(::ftruncate(tiny.get(), 15), 0);
  ASSERT_EQ(::fcntl(tiny.get(), F_ADD_SEALS, F_SEAL_SHRINK), 0);
  const auto refused = SharedPage::map(std::move(tiny));
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().message, "the page of the heartbeat is no sealed memory of 4096 bytes");
}

}  // namespace
}  // namespace thimble::guard
