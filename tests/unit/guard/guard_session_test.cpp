#include "guard/guard_session.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/socket.h>

#include <array>
#include <string>

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
  Result<GuardSession> accept() {
    page.heartbeat().is_driven = 1;
    const Handover handover{ZeroRoute::Write, 0, 3, {0, 7, 9}};
    EXPECT_TRUE(send_handover(daemon.get(), handover, node_.get(), page.descriptor()).has_value());
    return GuardSession::accept(guard_.get(), 1000);
  }
  // Looks for `ms` at a servo that beats or does not; how often the arm was given zero meanwhile.
  int run(GuardSession& guard, int ms, bool is_alive) {
    for (int i = 0; i < ms; i += 2) {
      now_ = now_ + kLookEvery;
      if (is_alive) page.heartbeat().beat();
      is_over = !guard.step(now_);
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
  bool is_over{false};

 private:
  Descriptor guard_;
  Descriptor arm_;
  Descriptor node_;
  MonotonicTime now_{};
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
  rig.page.heartbeat().is_driven = 0;
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
  rig.page.heartbeat().is_driven = 0;
  rig.run(*guard, 10, true);
  rig.daemon = Descriptor();
  EXPECT_EQ(rig.run(*guard, 1000, false), 0);
  EXPECT_TRUE(rig.is_over);
}

TEST(GuardSession, BelievesWhatTheDaemonSaidLastWhenItIsGone) {
  Rig rig;
  auto guard = rig.accept();
  rig.page.heartbeat().is_driven = 0;
  rig.run(*guard, 10, true);
  rig.page.heartbeat().is_driven = 1;  // and wrote a force, and died between two looks
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
  rig.page.heartbeat().is_driven = 0;
  EXPECT_EQ(rig.run(*guard, 100, true), 0);
}

TEST(GuardSession, OfAnArmThatIsGoneGoesOnAndCountsWhatWasRefused) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()), 0);
  const Descriptor daemon(ends[0]);
  const Descriptor guard(ends[1]);
  SharedPage page = std::move(SharedPage::create().value());
  const Descriptor null(::open("/dev/null", O_RDONLY | O_CLOEXEC));
  for (const ZeroRoute route : {ZeroRoute::Write, ZeroRoute::UsbBulk}) {
    ASSERT_TRUE(
        send_handover(daemon.get(), {route, 2, 16, {}}, null.get(), page.descriptor()).has_value());
    auto session = GuardSession::accept(guard.get(), 1000);
    ASSERT_TRUE(session.has_value());
    page.heartbeat().is_driven = 1;
    page.heartbeat().beat();
    EXPECT_TRUE(session->step(MonotonicTime{milliseconds(2)}));
    EXPECT_TRUE(session->step(MonotonicTime{milliseconds(30)}));
    EXPECT_EQ(session->zeros().refused(), 1U);
    EXPECT_EQ(session->zeros().written(), 0U);
  }
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
