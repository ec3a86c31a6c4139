#include "daemon/app/guard_keeper.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <thread>

#include "guard/handover.hpp"
#include "tests/support/temporary_folder.hpp"

// Guards that are real processes, of an arm that is a socket. Nothing here waits for a time; what a
// guard does when is told by unit_guard.
namespace thimble::app {
namespace {

using linux::Descriptor;

constexpr int kPatience_ms = 30'000;

class GuardKeeperTest : public testing::Test {
 protected:
  GuardKeeperTest() {
    std::array<int, 2> ends{};
    // Keeps reports apart: two may wait.
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()), 0);
    arm_ = Descriptor(ends[0]);
    node_ = Descriptor(ends[1]);
    settings_.program = THIMBLE_GUARD;
    settings_.share = [this](const bus::DeviceAddress& address) -> Result<linux::SharedDevice> {
      asked_for_ = address.text;
      if (is_gone_) return fail(Errc::NotFound, "no device at " + address.text);
      return linux::share_node(node_.get(), way_);
    };
    zero_.bytes.push_back(7);
    zero_.bytes.push_back(9);
  }
  // The arm's next report; empty when none came.
  std::string next_report() {
    pollfd readable{arm_.get(), POLLIN, 0};
    if (::poll(&readable, 1, kPatience_ms) != 1) return "";
    std::array<char, 3> report{};
    const ssize_t size = ::read(arm_.get(), report.data(), report.size());
    return {report.data(), static_cast<std::size_t>(std::max<ssize_t>(size, 0))};
  }
  std::unique_ptr<devices::ArmGuard> make() { return std::move(keeper().make().value()); }
  GuardKeeper& keeper() {
    if (!keeper_) keeper_ = std::make_unique<GuardKeeper>(settings_);
    return *keeper_;
  }
  // Asks it, and waits for its answer as the daemon does not.
  std::string refusal(devices::ArmGuard& guard, const std::string& address = "hid:42") {
    const Result<void> asked = guard.ask({address}, zero_);
    if (!asked) return asked.error().message;
    Result<bool> watching = guard.is_watching();
    while (watching && !*watching) {
      std::this_thread::yield();
      watching = guard.is_watching();
    }
    return watching ? "" : watching.error().message;
  }
  // A guard whose arm is gone tries it for 25 s more, and who runs this program waits for all that
  // has its output.
  static void let_go(devices::ArmGuard& guard) { guard.heartbeat().drive = 0; }
  static bool is_watching(devices::ArmGuard& guard) { return guard.is_watching().value_or(false); }

  Descriptor arm_;
  Descriptor node_;
  GuardSettings settings_;
  std::string asked_for_;
  bool is_gone_{false};
  linux::NodeWay way_{linux::NodeWay::HidrawAfterZero};
  ZeroCommand zero_;
  std::unique_ptr<GuardKeeper> keeper_;
};

const std::string kZeroOfHidraw{"\0\7\11", 3};

TEST_F(GuardKeeperTest, StartsAGuardThatLetsTheArmGoWhenTheBeatsStop) {
  const auto guard = make();
  EXPECT_FALSE(is_watching(*guard));
  ASSERT_EQ(refusal(*guard), "");
  EXPECT_EQ(asked_for_, "hid:42");
  EXPECT_TRUE(is_watching(*guard));
  guard->heartbeat().drive = 1;
  EXPECT_EQ(next_report(), kZeroOfHidraw);
  EXPECT_EQ(guard->heartbeat().interventions.load(), 1U);
  EXPECT_TRUE(is_watching(*guard));
}

// A serial port; a HID device whose reports are numbered: 7 is the number.
TEST_F(GuardKeeperTest, WhatWantsNoZeroInFrontTakesTheBytesAsTheyAre) {
  way_ = linux::NodeWay::AsTheyAre;
  for (const char* address : {"serial:42", "hid:42"}) {
    const auto guard = make();
    ASSERT_EQ(refusal(*guard, address), "");
    guard->heartbeat().drive = 1;
    EXPECT_EQ(next_report().substr(0, 2), "\7\11") << address;
    let_go(*guard);
  }
}

TEST_F(GuardKeeperTest, AGuardThatIsGivenUpLetsTheArmGo) {
  auto guard = make();
  ASSERT_EQ(refusal(*guard), "");
  guard->heartbeat().drive = 1;
  guard.reset();
  EXPECT_EQ(next_report(), kZeroOfHidraw);
}

TEST_F(GuardKeeperTest, TheNextDeviceHasAnotherGuardOnTheSameHeartbeat) {
  const auto guard = make();
  ASSERT_EQ(refusal(*guard), "");
  rt::Heartbeat* const heartbeat = &guard->heartbeat();
  heartbeat->drive = 1;
  ASSERT_EQ(refusal(*guard), "");
  EXPECT_EQ(next_report(), kZeroOfHidraw) << "of the first, which ended";
  EXPECT_TRUE(is_watching(*guard));
  EXPECT_EQ(&guard->heartbeat(), heartbeat);
  let_go(*guard);
}

TEST_F(GuardKeeperTest, SaysWhyThereIsNone) {
  is_gone_ = true;
  EXPECT_EQ(refusal(*make()), "no device at hid:42");
  is_gone_ = false;
  keeper_.reset();
  settings_.program = "/nowhere/thimble-guard";
  EXPECT_EQ(refusal(*make()),
            "/nowhere/thimble-guard cannot be started: No such file or directory");
  keeper_.reset();
  settings_.program = "/bin/true";
  EXPECT_EQ(refusal(*make()),
            "it ended; the journal has its word, journalctl -u 'thimble-guard@*'");
}

// As a port or a client's connection would be: the guard of a daemon that was killed must not keep
// it from the next one.
TEST_F(GuardKeeperTest, AGuardHasNothingOfWhatWasLeftOpenForIt) {
  const Descriptor left_open(::fcntl(STDERR_FILENO, F_DUPFD, 100));
  ASSERT_GE(left_open.get(), 100);
  const testing_support::TemporaryFolder folder;
  const std::filesystem::path program =
      folder.write("guard", "#!/bin/sh\ntest ! -e /proc/$$/fd/" + std::to_string(left_open.get()) +
                                " || exit 1\nprintf W >&0\nexec cat >/dev/null\n");
  ASSERT_EQ(::chmod(program.c_str(), 0755), 0);
  settings_.program = program;
  EXPECT_EQ(refusal(*make()), "");
}

// Or `thimbled | tee log` would not end before the last of its guards does.
TEST_F(GuardKeeperTest, KeepsTheDaemonsStandardErrorAndNotItsOutput) {
  const testing_support::TemporaryFolder folder;
  const std::filesystem::path program = folder.write(
      "guard",
      "#!/bin/sh\ntest \"$(readlink /proc/$$/fd/1)\" = /dev/null || exit 1\n"
      "test \"$(readlink /proc/$$/fd/2)\" = \"$(readlink /proc/$PPID/fd/2)\" || exit 1\n"
      "printf W >&0\nexec cat >/dev/null\n");  // until it is given up
  ASSERT_EQ(::chmod(program.c_str(), 0755), 0);
  settings_.program = program;
  EXPECT_EQ(refusal(*make()), "");
}

// As systemd's socket: whoever accepts is told everything.
TEST_F(GuardKeeperTest, PrefersTheSocketOfTheServiceAndSeesItsGuardEnd) {
  const testing_support::TemporaryFolder folder;
  settings_.socket = folder.path() / "guard.sock";
  settings_.program = "/nowhere/thimble-guard";
  Descriptor listener(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0));
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  settings_.socket.string().copy(static_cast<char*>(name.sun_path), sizeof(name.sun_path) - 1);
  ASSERT_EQ(::bind(listener.get(), reinterpret_cast<sockaddr*>(&name), sizeof(name)), 0);
  const auto guard = make();
  EXPECT_NE(refusal(*guard).find("thimble-guard.socket): Connection refused"), std::string::npos);

  ASSERT_EQ(::listen(listener.get(), 4), 0);
  Descriptor connection;
  std::thread service([&] {
    connection = Descriptor(::accept4(listener.get(), nullptr, nullptr, SOCK_CLOEXEC));
    const auto received = guard::receive_handover(connection.get(), kPatience_ms);
    EXPECT_TRUE(received.has_value());
    EXPECT_EQ(received->handover.route, guard::ZeroRoute::Hiddev);
    EXPECT_EQ(received->handover.size, 2U) << "no number before it";
    EXPECT_EQ(::send(connection.get(), "W", 1, 0), 1);
  });
  way_ = linux::NodeWay::Hiddev;
  EXPECT_EQ(refusal(*guard), "");
  service.join();
  EXPECT_TRUE(is_watching(*guard));
  connection = Descriptor();
  EXPECT_FALSE(is_watching(*guard));
}

}  // namespace
}  // namespace thimble::app
