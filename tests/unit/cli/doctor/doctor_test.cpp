#include "cli/doctor/accounts.hpp"
#include "tests/unit/cli/doctor/doctor_fixture.hpp"

// The machine, and the rights of the daemon.
namespace thimble::doctor {
namespace {

TEST_F(Doctor, FindsNothingOnAHealthyMachine) {
  EXPECT_THAT(complaints(), SizeIs(0));
  EXPECT_THAT(examine(facts()), SizeIs(16));
}

TEST_F(Doctor, MissesAnArmOnlyWhereThereIsNone) {
  machine_.remove("sys/class/hidraw/hidraw0");
  EXPECT_THAT(complaints(), SizeIs(0));
  const std::vector<Verdict> all = examine(facts());
  ASSERT_THAT(all, SizeIs(10));
  EXPECT_EQ(all[9].finding, "no arm that a driver knows is plugged in");
  machine_.remove("sys/class/hidraw");
  expect_complaint(Level::Warn, "arms", "the kernel shows no HID devices", "sudo modprobe hid");
}

TEST_F(Doctor, NamesAKernelThatIsNotRealTime) {
  machine_.remove("sys/kernel/realtime");
  EXPECT_THAT(complaints(), SizeIs(0)) << "the version says it, too";
  machine_.plant("proc/sys/kernel/version", "#1 SMP PREEMPT_DYNAMIC Debian 6.1.176-1\n");
  expect_complaint(Level::Warn, "kernel", "no real-time kernel",
                   "sudo apt-get install linux-image-rt-");
  EXPECT_THAT(complaints()[0].advice, HasSubstr("start the machine anew"));
  machine_.remove("proc/sys/kernel/osrelease");
  expect_look(Level::Warn, "kernel", "does not tell", "uname -a");
}

TEST_F(Doctor, NamesAKernelThatHoldsRealTimeThreadsBack) {
  const std::string file = "proc/sys/kernel/sched_rt_runtime_us";
  const std::string mend = "echo 'kernel.sched_rt_runtime_us = ";
  machine_.plant(file, "0\n");
  expect_complaint(Level::Wrong, "rt-share", "lets no real-time thread run",
                   mend + "950000' | sudo tee /etc/sysctl.d/99-thimble.conf && sudo sysctl -p");
  machine_.plant(file, "500000\n");
  expect_complaint(Level::Warn, "rt-share", "only 500 of each 1000 ms", mend + "950000'");
  machine_.plant(file, "-1\n");
  EXPECT_THAT(complaints(), SizeIs(0));
  machine_.plant("proc/sys/kernel/sched_rt_period_us", "100000\n");
  machine_.plant(file, "95000\n");
  EXPECT_THAT(complaints(), SizeIs(0)) << "the share counts, not the time";
  machine_.plant(file, "94000\n");
  expect_complaint(Level::Warn, "rt-share", "only 94 of each 100 ms", mend + "95000'");
  machine_.remove(file);
  expect_look(Level::Warn, "rt-share", "not known", "sysctl kernel.sched_rt_runtime_us");
}

TEST_F(Doctor, NamesASlowClockSource) {
  const std::string file = PlantedMachine::kClock + "current_clocksource";
  machine_.plant(file, "hpet\n");
  expect_complaint(Level::Warn, "clock", "'hpet' is slow", "echo tsc | sudo tee /sys/devices");
  machine_.plant(file, "jiffies\n");
  expect_complaint(Level::Wrong, "clock", "'jiffies' is coarse", "echo tsc | sudo tee");
  machine_.plant(PlantedMachine::kClock + "available_clocksource", "jiffies \n");
  expect_look(Level::Wrong, "clock", "'jiffies' is coarse", "sudo dmesg");
  machine_.remove(file);
  expect_look(Level::Warn, "clock", "not known", "current_clocksource");
}

TEST_F(Doctor, NamesEachCpuWhoseFrequencyFollowsTheLoad) {
  machine_.plant_governor("cpu1", "schedutil");
  machine_.plant_governor("cpu10", "powersave");
  expect_complaint(Level::Warn, "governor", "CPU 1 'schedutil', 10 'powersave' is not held",
                   "echo performance | sudo tee /sys/devices/system/cpu/cpu*/cpufreq/");
  for (const char* cpu : {"cpu0", "cpu1", "cpu10"}) {
    machine_.remove(std::string("sys/devices/system/cpu/") + cpu);
  }
  expect_look(Level::Warn, "governor", "the CPUs are not known", "ls /sys/devices/system/cpu");
}

TEST_F(Doctor, NamesAMissingGroup) {
  machine_.plant("etc/group", "root:x:0:\n");
  std::vector<Verdict> all = complaints();
  ASSERT_THAT(all, SizeIs(3)) << "the nodes belong to some other group, too";
  EXPECT_EQ(all[1].check, "node /dev/hidraw0");
  EXPECT_THAT(all[1].command, testing::StartsWith("sudo addgroup --system thimble && echo"));
  EXPECT_EQ(all[2].check, "raw-node /dev/bus/usb/001/004");
  all.resize(1);
  expect_complaint(all, Level::Wrong, "group", "there is no group 'thimble'",
                   "sudo addgroup --system thimble && sudo adduser haptics thimble");
  machine_.remove("sys/class/hidraw/hidraw0");
  expect_complaint(Level::Warn, "group", "there is no group 'thimble'",
                   "sudo addgroup --system thimble && sudo adduser haptics thimble");
  machine_.plant_service("thimbled.service");
  expect_complaint(Level::Warn, "group", "there is no group 'thimble'",
                   "sudo addgroup --system thimble && sudo mkdir -p "
                   "/etc/systemd/system/thimbled.service.d && ");
}

TEST_F(Doctor, NamesADaemonOutsideTheGroup) {
  Facts facts = this->facts();
  facts.process.groups = {63998};
  facts.controllers.clear();
  facts.dma_latency.mode = 0666;
  expect_complaint(complaints(facts), Level::Warn, "group",
                   "thimbled (process 77 of user 'haptics') is not in the group",
                   "sudo adduser haptics thimble");
  facts.process.user_name = "o'hara";
  expect_complaint(complaints(facts), Level::Warn, "group", "is not in the group",
                   "sudo adduser 'o'\\''hara' thimble");
  facts.process.user_name.clear();
  expect_complaint(complaints(facts), Level::Warn, "group", "is not in the group",
                   "sudo adduser \"$(id -nu 64000)\" thimble");
  facts.process.unit = "thimbled@a\\x2db.service";
  expect_complaint(complaints(facts), Level::Warn, "group", "is not in the group",
                   "printf '[Service]\\nSupplementaryGroups=thimble\\n' | sudo tee "
                   "/etc/systemd/system/'thimbled@a\\x2db.service'.d/thimble-group.conf");
}

TEST_F(Doctor, NamesWhoAsksWhereNoDaemonRunsOutsideTheGroup) {
  Facts facts = this->facts();
  facts.process.pid = 0;
  facts.process.groups.clear();
  facts.controllers.clear();
  facts.dma_latency.mode = 0666;
  expect_complaint(complaints(facts), Level::Warn, "group", "a thimbled started here",
                   "sudo adduser \"$USER\" thimble");
}

TEST_F(Doctor, NamesAUserWhoBecameAMemberAfterTheLogin) {
  Facts facts = this->facts();
  facts.process.login_groups = {*facts.thimble_group};
  facts.process.groups = {63998};
  facts.controllers.clear();
  facts.dma_latency.mode = 0666;
  const auto expect = [&](const std::string& command, const std::string& look_with,
                          const std::string& advice) {
    const std::vector<Verdict> all = complaints(facts);
    expect_complaint(all, Level::Warn, "group", "though its user is by now", command);
    EXPECT_EQ(all.at(0).command, command) << "nobody is added twice";
    EXPECT_EQ(all.at(0).look_with, look_with);
    EXPECT_THAT(all.at(0).advice, HasSubstr(advice));
  };
  expect("", "id haptics", "log in again as that user");
  facts.process.unit = "user@64000.service";
  expect("", "id haptics", "when its user has logged out everywhere");
  facts.process.unit = "thimbled.service";
  expect("sudo systemctl restart thimbled.service", "", "its arms lose their force");
}

TEST_F(Doctor, NeverStartsTheManagerOfAUserAnew) {
  machine_.plant_limits("0", "unlimited");
  machine_.plant_service("user@64000.service");
  expect_complaint(Level::Wrong, "rtprio", "(limit: 0)",
                   "/etc/systemd/system/user@64000.service.d/thimble-rtprio.conf && "
                   "sudo systemctl daemon-reload");
  EXPECT_THAT(complaints()[0].command, Not(HasSubstr("restart")));
}

TEST_F(Doctor, NamesAccountsThatCannotBeLookedUp) {
  std::filesystem::resize_file(machine_.root() / "etc/group", kMaxAccountBytes + 1);
  const std::vector<Verdict> all = complaints();
  ASSERT_THAT(all, SizeIs(3));
  expect_one({all[0]}, Level::Warn, "group", "could not be looked up: /etc/group has more than");
  EXPECT_EQ(all[0].command, "") << "nobody knows that it is missing";
  EXPECT_EQ(all[0].look_with, "getent group thimble");
  EXPECT_EQ(all[1].check, "node /dev/hidraw0");
  EXPECT_THAT(all[1].finding, HasSubstr("whether that is 'thimble' is not known"));
  EXPECT_THAT(all[1].command, Not(HasSubstr("addgroup")));
}

TEST_F(Doctor, NamesAMissingRightToRealTimePriority) {
  for (const std::string limit : {"0", "79"}) {
    machine_.plant_limits(limit, "unlimited");
    expect_complaint(Level::Wrong, "rtprio", "(limit: " + limit + ")",
                     "echo '@thimble - rtprio 80' | sudo tee /etc/security/limits.d/");
  }
  machine_.plant_limits("unlimited", "unlimited");
  EXPECT_THAT(complaints(), SizeIs(0));
}

TEST_F(Doctor, HoldsTheLimitToTheConfiguredPriority) {
  machine_.plant_limits("85", "unlimited");
  Facts facts = this->facts();
  EXPECT_THAT(complaints(facts), SizeIs(0));
  facts.servo.priority = 85;
  EXPECT_THAT(complaints(facts), SizeIs(0));
  facts.servo.priority = 86;
  expect_complaint(complaints(facts), Level::Wrong, "rtprio", "real-time priority 86 (limit: 85)",
                   "echo '@thimble - rtprio 86'");
}

TEST_F(Doctor, MendsTheLimitsOfAServiceInItsUnit) {
  machine_.plant_limits("0", "unlimited");
  machine_.plant_service("haptics.service");
  expect_complaint(Level::Wrong, "rtprio", "(limit: 0)",
                   "sudo mkdir -p /etc/systemd/system/haptics.service.d && "
                   "printf '[Service]\\nLimitRTPRIO=80\\n' | sudo tee "
                   "/etc/systemd/system/haptics.service.d/thimble-rtprio.conf && "
                   "sudo systemctl daemon-reload && sudo systemctl restart haptics.service");
  EXPECT_THAT(complaints()[0].advice, HasSubstr("its arms lose their force"));
}

TEST_F(Doctor, NamesALimitOfLockedMemory) {
  machine_.plant_limits("98", "8388608");
  expect_complaint(Level::Wrong, "memlock", "(limit: 8192 KiB)",
                   "echo '@thimble - memlock unlimited' | sudo tee /etc/security/limits.d/");
  machine_.plant_service("thimbled.service");
  expect_complaint(Level::Wrong, "memlock", "(limit: 8192 KiB)",
                   "printf '[Service]\\nLimitMEMLOCK=infinity\\n' | sudo tee "
                   "/etc/systemd/system/thimbled.service.d/thimble-memlock.conf && ");
}

TEST_F(Doctor, LooksAtItselfWhereNoDaemonRuns) {
  machine_.remove("proc/77");
  machine_.plant("proc/self/status", "Uid:\t1 64000 1 1\nGid:\t1 " + PlantedMachine::group() +
                                         " 1 1\nGroups:\t\nCapEff:\t0000000000804000\n");
  machine_.plant("proc/self/limits", "");
  EXPECT_THAT(complaints(), SizeIs(0)) << "CAP_SYS_NICE and CAP_IPC_LOCK stand for the limits";
  machine_.plant("proc/self/status", "Uid:\t1 64000 1 1\nGid:\t1 " + PlantedMachine::group() +
                                         " 1 1\nCapEff:\t0000000000004000\n");
  expect_complaint(Level::Wrong, "rtprio", "a thimbled started here may not take", "rtprio 80");
}

TEST_F(Doctor, NamesALatencyNodeThatIsOutOfReach) {
  machine_.chmod("dev/cpu_dma_latency", 0600);
  expect_complaint(Level::Warn, "idle-states", "may not write /dev/cpu_dma_latency",
                   "KERNEL==\"cpu_dma_latency\", GROUP=\"thimble\", MODE=\"0660\"");
  machine_.remove("dev/cpu_dma_latency");
  expect_look(Level::Warn, "idle-states", "there is no /dev/cpu_dma_latency", "cpuidle");
  EXPECT_THAT(complaints()[0].advice, HasSubstr("intel_idle.max_cstate=1"));
  machine_.plant("sys/devices/system/cpu/cpuidle/current_driver", "none\n");
  EXPECT_THAT(complaints(), SizeIs(0)) << "a kernel that lets no CPU sleep";
}

// Whatever is wrong: no command that cannot be typed twice, or that stops what others do.
TEST_F(Doctor, GivesNoCommandThatANeighbourWouldRegret) {
  Facts bare;
  bare.process.unit = "user@5.service";
  Controller controller;
  controller.node.path = "/dev/hidraw0";
  controller.node.is_there = true;
  controller.node.mode = 0666;
  controller.usb_port = "1-4.2";
  controller.power_control = "auto";
  bare.controllers = {controller};
  for (const Verdict& verdict : examine(bare)) {
    for (const char* word : {"reboot", "tee -a", "sed ", "usermod", "setcap", "chmod", "restart"}) {
      EXPECT_THAT(verdict.command, Not(HasSubstr(word))) << verdict.check;
    }
  }
}

TEST_F(Doctor, KnowsNothingOfAnEmptyFolderAndStaysCalm) {
  machine_.remove("proc");
  machine_.remove("sys");
  machine_.remove("dev");
  machine_.remove("etc");
  EXPECT_THAT(complaints(),
              testing::Each(AllOf(Field(&Verdict::reason, testing::Not("")),
                                  testing::AnyOf(Field(&Verdict::command, testing::Not("")),
                                                 Field(&Verdict::look_with, testing::Not(""))))));
}

}  // namespace
}  // namespace thimble::doctor
