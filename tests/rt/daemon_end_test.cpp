// What the daemon says of its own end to whoever started it.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <future>
#include <sstream>

#include "daemon/app/application.hpp"
#include "daemon/app/daemon.hpp"
#include "daemon/app/summary_file.hpp"
#include "tests/rt/in_child_process.hpp"
#include "tests/rt/refused_threads.hpp"
#include "tests/support/fake_hidapi.hpp"
#include "tests/support/mock_machine.hpp"
#include "tests/support/temporary_folder.hpp"

namespace thimble::test {
namespace {

// A puck, which needs no guard, on a machine that is made up.
struct PuckMachine {
  MockMachine machine;
  FakeHidWire wire;
  PuckMachine() { wire.attach("/dev/hidraw0"); }
  void plug() {
    machine.plug_virtual(MockMachine::HidDevice{.ids = "0003:0000046D:0000C626",
                                                .serial_number = "P1",
                                                .report_descriptor = numbered_reports(6, 2)});
  }
};

struct DaemonEnd : testing::Test {
  PuckMachine puck;
  testing_support::TemporaryFolder folder;
  session::Plugins plugins;
  linux::RealtimeProcess process;
  app::Options options;
  std::unique_ptr<app::Daemon> sut;

  void start() {
    config::Config config;
    config.daemon.socket = (folder.path() / "socket").string();
    config.daemon.flight_directory = folder.path().string();
    config::ArmConfig& arm = config.arms.emplace_back();
    arm.name = "left";
    arm.device = "hid:P1";
    arm.world = "box";
    config::WorldConfig& world = config.worlds.emplace_back();
    world.name = "box";
    world.source = "box:3";
    sut = std::make_unique<app::Daemon>(config, options, plugins);
    const Result<void> started = sut->start(process);
    ASSERT_TRUE(started) << started.error().message;
  }
};

TEST_F(DaemonEnd, AsToldIsNoError) {
  options.for_s = 0.05;
  start();
  EXPECT_TRUE(sut->run());
}

// Else a service manager that restarts what failed would leave the arm without a servo.
TEST_F(DaemonEnd, ForAnArmThatCameAndCannotBeServedIsAnErrorThatNamesIt) {
  options.for_s = 60;
  start();
  puck.plug();
  const RefusedThreads refused(RefusedThreads::Which::WithAttributes);
  const Result<void> ended = sut->run();
  ASSERT_FALSE(ended) << "an arm that nobody serves is no service";
  EXPECT_EQ(ended.error().code, Errc::System);
  for (const char* said : {"arm 'left': its servo could not be started", "TasksMax="}) {
    EXPECT_NE(ended.error().message.find(said), std::string::npos) << ended.error().message;
  }
}

// Whoever called ends the process then, with what is not destroyed.
TEST_F(DaemonEnd, WithoutAThreadToCloseWithIsSaidAndNotThrown) {
  options.for_s = 0.05;
  start();
  ASSERT_TRUE(sut->run());
  const RefusedThreads refused(RefusedThreads::Which::All);
  const Result<void> closed = sut->close(std::chrono::seconds(60));
  ASSERT_FALSE(closed);
  EXPECT_EQ(closed.error().code, Errc::System);
  EXPECT_FALSE(std::filesystem::exists(folder / "socket")) << "it ended in order";
}

TEST_F(DaemonEnd, ASummaryThatNoThreadWritesIsSaid) {
  app::SummaryFile summary((folder / "summary.json").string());
  ASSERT_TRUE(summary.prepare());
  const RefusedThreads refused(RefusedThreads::Which::All);
  EXPECT_EQ(summary.write("text").error().code, Errc::System);
}

// A HID device in whose opening the kernel hangs: by hand it would swallow every Ctrl-C.
TEST(HangingDaemonEnd, IsNotHeldUpByADeviceThatHangsForEver) {
  const testing_support::TemporaryFolder folder;
  const std::string file = folder.write("daemon.toml", R"(
[[arm]]
name = "left"
device = "hid:P1"
world = "box"
[[world]]
name = "box"
source = "box:3"
)");
  app::Options options;
  options.config = file;
  options.overrides = {"daemon.socket=" + (folder / "socket").string(),
                       "daemon.flight_directory=" + folder.path().string()};
  options.summary = (folder / "summary.json").string();
  options.for_s = 0.05;
  const std::string log = folder.write("log", "");
  const std::string ended = in_child_process(Rights::AsTheTest, [&]() -> std::string {
    if (std::freopen(log.c_str(), "w", stderr) == nullptr) return "no log";
    // The machine has threads, and locks that one of them may hold during a fork: made here.
    PuckMachine puck;
    puck.wire.at_next_opening([] { std::promise<void>().get_future().wait(); });
    puck.plug();
    ::_exit(app::run(options));
  });
  EXPECT_EQ(ended, "") << "as told is no failure";
  std::ostringstream said;
  said << std::ifstream(log).rdbuf();
  EXPECT_NE(said.str().find("ended without closing it"), std::string::npos) << said.str();
}

}  // namespace
}  // namespace thimble::test
