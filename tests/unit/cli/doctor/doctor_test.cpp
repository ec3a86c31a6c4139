#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "cli/doctor/checks.hpp"
#include "cli/doctor/read_facts.hpp"
#include "tests/unit/cli/doctor/planted_machine.hpp"

// Each test breaks one thing of a healthy machine: that check and no other one has to say so.
namespace thimble::doctor {
namespace {

using testing::AllOf;
using testing::Field;
using testing::HasSubstr;
using testing::SizeIs;

class Doctor : public testing::Test {
 protected:
  [[nodiscard]] std::vector<Verdict> complaints() const {
    std::vector<Verdict> verdicts = examine(read_facts(machine_.root()));
    std::erase_if(verdicts, [](const Verdict& verdict) { return verdict.level == Level::Ok; });
    return verdicts;
  }
  // The one complaint, which must be complete.
  void expect_complaint(Level level, const std::string& check, const std::string& finding,
                        const std::string& command) const {
    const std::vector<Verdict> all = complaints();
    ASSERT_THAT(all, SizeIs(1)) << check;
    EXPECT_EQ(all[0].level, level);
    EXPECT_EQ(all[0].check, check);
    EXPECT_THAT(all[0].finding, HasSubstr(finding));
    EXPECT_FALSE(all[0].reason.empty());
    EXPECT_THAT(all[0].command, HasSubstr(command));
  }

  PlantedMachine machine_;
};

TEST_F(Doctor, FindsNothingOnAHealthyMachine) {
  EXPECT_THAT(complaints(), SizeIs(0));
  EXPECT_THAT(examine(read_facts(machine_.root())), SizeIs(13));
}

TEST_F(Doctor, MissesAnArmOnlyWhereThereIsNone) {
  machine_.remove("sys/class/hidraw/hidraw0");
  EXPECT_THAT(complaints(), SizeIs(0));
  EXPECT_THAT(examine(read_facts(machine_.root())), SizeIs(8));
}

TEST_F(Doctor, NamesAKernelThatIsNotRealTime) {
  machine_.remove("sys/kernel/realtime");
  EXPECT_THAT(complaints(), SizeIs(0)) << "the version says it, too";
  machine_.plant("proc/sys/kernel/version", "#1 SMP PREEMPT_DYNAMIC Debian 6.1.176-1\n");
  expect_complaint(Level::Warn, "kernel", "no real-time kernel",
                   "sudo apt-get install linux-image-rt-");
  machine_.remove("proc/sys/kernel/osrelease");
  expect_complaint(Level::Warn, "kernel", "does not tell", "uname -a");
}

TEST_F(Doctor, NamesAKernelThatHoldsRealTimeThreadsBack) {
  const std::string file = "proc/sys/kernel/sched_rt_runtime_us";
  machine_.plant(file, "0\n");
  expect_complaint(Level::Wrong, "rt-share", "lets no real-time thread run",
                   "sudo sysctl -w kernel.sched_rt_runtime_us=950000");
  machine_.plant(file, "500000\n");
  expect_complaint(Level::Warn, "rt-share", "only 500 ms", "sudo sysctl -w");
  machine_.plant(file, "-1\n");
  EXPECT_THAT(complaints(), SizeIs(0));
}

TEST_F(Doctor, NamesASlowClockSource) {
  const std::string file = PlantedMachine::kClock + "current_clocksource";
  machine_.plant(file, "hpet\n");
  expect_complaint(Level::Warn, "clock", "'hpet' is slow", "echo tsc | sudo tee /sys/devices");
  machine_.plant(file, "jiffies\n");
  expect_complaint(Level::Wrong, "clock", "'jiffies' is coarse", "echo tsc | sudo tee");
  machine_.plant(PlantedMachine::kClock + "available_clocksource", "jiffies \n");
  expect_complaint(Level::Wrong, "clock", "'jiffies' is coarse", "sudo dmesg");
  machine_.remove(file);
  expect_complaint(Level::Warn, "clock", "not known", "current_clocksource");
}

TEST_F(Doctor, NamesEachCpuWhoseFrequencyFollowsTheLoad) {
  machine_.plant_governor("cpu1", "schedutil");
  machine_.plant_governor("cpu10", "powersave");
  expect_complaint(Level::Warn, "governor", "CPU 1 'schedutil', 10 'powersave' follows",
                   "echo performance | sudo tee /sys/devices/system/cpu/cpu*/cpufreq/");
}

TEST_F(Doctor, NamesAMissingGroup) {
  machine_.plant("etc/group", "root:x:0:\n");
  expect_complaint(Level::Wrong, "group", "there is no group 'thimble'",
                   "sudo addgroup --system thimble");
  machine_.remove("sys/class/hidraw/hidraw0");
  expect_complaint(Level::Warn, "group", "there is no group 'thimble'", "sudo adduser $USER");
}

TEST_F(Doctor, NamesADaemonOutsideTheGroup) {
  machine_.plant("etc/group", "thimble:x:63999:\n");
  expect_complaint(Level::Wrong, "group", "thimbled (process 77) is not in the group",
                   "sudo adduser $USER thimble");
}

TEST_F(Doctor, NamesAMissingRightToRealTimePriority) {
  for (const std::string limit : {"0", "79"}) {
    machine_.plant_limits(limit, "unlimited");
    expect_complaint(Level::Wrong, "rtprio", "(limit: " + limit + ")",
                     "echo '@thimble - rtprio 80' | sudo tee -a /etc/security/limits.d/");
  }
  machine_.plant_limits("unlimited", "unlimited");
  EXPECT_THAT(complaints(), SizeIs(0));
}

TEST_F(Doctor, NamesALimitOfLockedMemory) {
  machine_.plant_limits("98", "8388608");
  expect_complaint(Level::Wrong, "memlock", "(limit: 8192 KiB)",
                   "echo '@thimble - memlock unlimited' | sudo tee -a /etc/security/limits.d/");
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
  expect_complaint(Level::Warn, "idle-states", "there is no /dev/cpu_dma_latency", "max_cstate");
}

TEST_F(Doctor, NamesAMissingDeviceNode) {
  machine_.remove("dev/hidraw0");
  expect_complaint(Level::Wrong, "node /dev/hidraw0", "is missing", "sudo udevadm trigger");
}

TEST_F(Doctor, NamesADeviceNodeThatMayNotBeOpened) {
  for (const unsigned mode : {0600U, 0640U, 0620U}) {
    machine_.chmod("dev/hidraw0", mode);
    expect_complaint(Level::Wrong, "node /dev/hidraw0", "may not be read and written",
                     "ATTRS{idVendor}==\"1234\", ATTRS{idProduct}==\"0006\", GROUP=\"thimble\", "
                     "MODE=\"0660\"' | sudo tee /etc/udev/rules.d/99-thimble-1234-0006.rules");
  }
}

TEST_F(Doctor, NamesADeviceNodeThatEverybodyMayWrite) {
  machine_.chmod("dev/hidraw0", 0666);
  expect_complaint(Level::Wrong, "node /dev/hidraw0", "every user may write", "MODE=\"0660\"");
}

TEST_F(Doctor, NamesALowSpeedDevice) {
  machine_.plant(PlantedMachine::kUsb + "speed", "1.5\n");
  expect_complaint(Level::Wrong, "usb-speed /dev/hidraw0", "low speed", "lsusb -t");
}

TEST_F(Doctor, NamesADeviceWithoutASpeed) {
  machine_.remove(PlantedMachine::kUsb + "speed");
  machine_.remove("sys/devices/pci0000:00/0000:00:14.0/usb1/speed");
  expect_complaint(Level::Warn, "usb-speed /dev/hidraw0", "not known", "lsusb -t");
}

TEST_F(Doctor, NamesADeviceBehindAHub) {
  machine_.replug("1-4.2");
  expect_complaint(Level::Warn, "usb-port /dev/hidraw0", "behind a hub (port 1-4.2)", "lsusb -t");
}

TEST_F(Doctor, NamesADeviceThatIsPutToSleep) {
  machine_.plant(PlantedMachine::kUsb + "power/control", "auto\n");
  expect_complaint(Level::Warn, "usb-power /dev/hidraw0", "put it to sleep",
                   "echo on | sudo tee /sys/bus/usb/devices/1-4/power/control");
}

TEST_F(Doctor, NamesAnotherProgramThatHoldsTheDevice) {
  machine_.plant_process(300, "steam", "/dev/hidraw0");
  machine_.plant_process(301, "steam", "/dev/hidraw01");
  machine_.plant_process(302, "thimble-guard", "/dev/hidraw0");
  expect_complaint(Level::Wrong, "holder /dev/hidraw0", "held by 'steam' (process 300)",
                   "sudo kill 300");
}

TEST_F(Doctor, NamesASecondDaemonThatHoldsTheDevice) {
  machine_.plant_process(300, "thimbled", "/dev/hidraw0");
  expect_complaint(Level::Wrong, "holder /dev/hidraw0", "'thimbled' (process 300)",
                   "sudo kill 300");
}

TEST_F(Doctor, SaysThatItMayHaveOverlookedAHolder) {
  machine_.plant("proc/1/comm", "systemd\n");  // and no fd that could be read
  expect_complaint(Level::Warn, "holder /dev/hidraw0", "but 1 processes", "sudo thimble doctor");
}

TEST_F(Doctor, KnowsNothingOfAnEmptyFolderAndStaysCalm) {
  machine_.remove("proc");
  machine_.remove("sys");
  machine_.remove("dev");
  machine_.remove("etc");
  EXPECT_THAT(complaints(), testing::Each(AllOf(Field(&Verdict::reason, testing::Not("")),
                                                Field(&Verdict::command, testing::Not("")))));
}

TEST_F(Doctor, LooksOnlyAtDevicesWithTheIdsOfAnArm) {
  machine_.plant(PlantedMachine::kUsb + "1-4:1.0/0003:1234:0006.0001/uevent",
                 "HID_ID=0003:0000046D:0000C077\n");
  machine_.chmod("dev/hidraw0", 0666);
  EXPECT_THAT(complaints(), SizeIs(0));
}

}  // namespace
}  // namespace thimble::doctor
