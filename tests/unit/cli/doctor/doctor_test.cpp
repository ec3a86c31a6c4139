#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/xattr.h>

#include <algorithm>

#include "cli/doctor/checks.hpp"
#include "cli/doctor/read_facts.hpp"
#include "daemon/session/plugins.hpp"
#include "tests/unit/cli/doctor/access_list_bytes.hpp"
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
  // Whoever runs the test owns the planted files and stands for root.
  [[nodiscard]] Facts facts() const {
    Facts facts = read_facts(machine_.root(), plugins_.drivers);
    for (Controller& controller : facts.controllers) {
      if (controller.node.user == ::geteuid()) controller.node.user = 0;
    }
    return facts;
  }
  [[nodiscard]] std::vector<Verdict> complaints() const { return complaints(facts()); }
  [[nodiscard]] static std::vector<Verdict> complaints(const Facts& facts) {
    std::vector<Verdict> verdicts = examine(facts);
    std::erase_if(verdicts, [](const Verdict& verdict) { return verdict.level == Level::Ok; });
    return verdicts;
  }
  // The one complaint, which must be complete.
  void expect_complaint(Level level, const std::string& check, const std::string& finding,
                        const std::string& command) const {
    expect_complaint(complaints(), level, check, finding, command);
  }
  static void expect_complaint(const std::vector<Verdict>& all, Level level,
                               const std::string& check, const std::string& finding,
                               const std::string& command) {
    expect_one(all, level, check, finding);
    if (all.size() != 1) return;
    EXPECT_THAT(all[0].command, HasSubstr(command));
  }
  // One that no command mends: there is only something to look at.
  void expect_look(Level level, const std::string& check, const std::string& finding,
                   const std::string& look_with) const {
    const std::vector<Verdict> all = complaints();
    expect_one(all, level, check, finding);
    if (all.size() != 1) return;
    EXPECT_EQ(all[0].command, "");
    EXPECT_THAT(all[0].look_with, HasSubstr(look_with));
    EXPECT_NE(all[0].advice, "");
  }
  static void expect_one(const std::vector<Verdict>& all, Level level, const std::string& check,
                         const std::string& finding) {
    ASSERT_THAT(all, SizeIs(1)) << check;
    EXPECT_EQ(all[0].level, level);
    EXPECT_EQ(all[0].check, check);
    EXPECT_THAT(all[0].finding, HasSubstr(finding));
    EXPECT_FALSE(all[0].reason.empty());
  }

  PlantedMachine machine_;
  session::Plugins plugins_;
};

TEST_F(Doctor, FindsNothingOnAHealthyMachine) {
  EXPECT_THAT(complaints(), SizeIs(0));
  EXPECT_THAT(examine(facts()), SizeIs(13));
}

TEST_F(Doctor, MissesAnArmOnlyWhereThereIsNone) {
  machine_.remove("sys/class/hidraw/hidraw0");
  EXPECT_THAT(complaints(), SizeIs(0));
  EXPECT_THAT(examine(facts()), SizeIs(8));
}

TEST_F(Doctor, NamesAKernelThatIsNotRealTime) {
  machine_.remove("sys/kernel/realtime");
  EXPECT_THAT(complaints(), SizeIs(0)) << "the version says it, too";
  machine_.plant("proc/sys/kernel/version", "#1 SMP PREEMPT_DYNAMIC Debian 6.1.176-1\n");
  expect_complaint(Level::Warn, "kernel", "no real-time kernel",
                   "sudo apt-get install linux-image-rt-");
  machine_.remove("proc/sys/kernel/osrelease");
  expect_look(Level::Warn, "kernel", "does not tell", "uname -a");
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
  expect_look(Level::Wrong, "clock", "'jiffies' is coarse", "sudo dmesg");
  machine_.remove(file);
  expect_look(Level::Warn, "clock", "not known", "current_clocksource");
}

TEST_F(Doctor, NamesEachCpuWhoseFrequencyFollowsTheLoad) {
  machine_.plant_governor("cpu1", "schedutil");
  machine_.plant_governor("cpu10", "powersave");
  expect_complaint(Level::Warn, "governor", "CPU 1 'schedutil', 10 'powersave' follows",
                   "echo performance | sudo tee /sys/devices/system/cpu/cpu*/cpufreq/");
}

TEST_F(Doctor, NamesAMissingGroup) {
  machine_.plant("etc/group", "root:x:0:\n");
  std::vector<Verdict> all = complaints();
  ASSERT_THAT(all, SizeIs(2)) << "the node belongs to some other group, too";
  EXPECT_EQ(all[1].check, "node /dev/hidraw0");
  all.pop_back();
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
                   "thimbled (process 77) is not in the group", "sudo adduser haptics thimble");
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
                   "echo '@thimble - memlock unlimited' | sudo tee -a /etc/security/limits.d/");
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
                     "ATTRS{idVendor}==\"1234\", ATTRS{idProduct}==\"0006\", OWNER:=\"root\", "
                     "GROUP:=\"thimble\", MODE:=\"0660\", TAG-=\"uaccess\"' | sudo tee "
                     "/etc/udev/rules.d/72-thimble-1234-0006.rules");
  }
}

TEST_F(Doctor, NamesADeviceNodeThatEverybodyMayOpen) {
  for (const unsigned mode : {0666U, 0664U, 0662U}) {
    machine_.chmod("dev/hidraw0", mode);
    expect_complaint(Level::Wrong, "node /dev/hidraw0", "every user may open", "MODE:=\"0660\"");
  }
}

TEST_F(Doctor, NamesADeviceNodeOfAnotherGroup) {
  constexpr std::uint32_t kPlugdev = 46;
  Facts facts = this->facts();
  facts.controllers[0].node.group = kPlugdev;
  facts.process.groups.push_back(kPlugdev);  // so that the daemon could open it
  expect_complaint(complaints(facts), Level::Wrong, "node /dev/hidraw0",
                   "belongs to group 46 and not to the group 'thimble'", "GROUP:=\"thimble\"");
  facts.process.capabilities = ~std::uint64_t{0};
  EXPECT_THAT(complaints(facts), SizeIs(1)) << "nor is it well for a daemon that may open all";
}

TEST_F(Doctor, NamesADeviceNodeOfAPersonOrOfRootAlone) {
  Facts facts = this->facts();
  facts.controllers[0].node.user = facts.process.user;
  facts.controllers[0].node.mode = 0600;
  expect_complaint(complaints(facts), Level::Wrong, "node /dev/hidraw0",
                   "belongs to user 64000 and not to root", "OWNER:=\"root\"");
  facts.controllers[0].node.user = facts.controllers[0].node.group = 0;
  expect_complaint(complaints(facts), Level::Wrong, "node /dev/hidraw0",
                   "may not be read and written by the daemon", "GROUP:=\"thimble\"");
}

TEST_F(Doctor, NamesADeviceNodeThatAnAccessControlListOpens) {
  Facts facts = this->facts();
  AccessList& list = facts.controllers[0].node.access_list;
  list.users = {1000};
  expect_complaint(complaints(facts), Level::Wrong, "node /dev/hidraw0",
                   "opens /dev/hidraw0 to user 1000",
                   "sudo setfacl --remove-all /dev/hidraw0; echo 'KERNEL==");
  list = {{}, {46}};
  expect_complaint(complaints(facts), Level::Wrong, "node /dev/hidraw0", "to group 46",
                   "TAG-=\"uaccess\"");
  list = {{}, {}, true};
  expect_complaint(complaints(facts), Level::Wrong, "node /dev/hidraw0", "cannot be read",
                   "setfacl");
}

TEST_F(Doctor, ReadsTheAccessControlListOfANode) {
  const std::vector<std::byte> bytes = access_list_bytes(kListOfASeat);
  if (::setxattr((machine_.root() / "dev/hidraw0").c_str(), "system.posix_acl_access", bytes.data(),
                 bytes.size(), 0) != 0) {
    GTEST_SKIP() << "the folder of temporary files holds no access control lists";
  }
  expect_complaint(Level::Wrong, "node /dev/hidraw0", "opens /dev/hidraw0 to user 1000",
                   "TAG-=\"uaccess\"");
}

TEST_F(Doctor, NamesALowSpeedDevice) {
  machine_.plant(PlantedMachine::kUsb + "speed", "1.5\n");
  expect_look(Level::Wrong, "usb-speed /dev/hidraw0", "low speed", "lsusb -t");
}

TEST_F(Doctor, NamesADeviceWithoutASpeed) {
  machine_.remove(PlantedMachine::kUsb + "speed");
  machine_.remove("sys/devices/pci0000:00/0000:00:14.0/usb1/speed");
  expect_look(Level::Warn, "usb-speed /dev/hidraw0", "not known", "lsusb -t");
}

TEST_F(Doctor, NamesADeviceBehindAHub) {
  machine_.replug("1-4.2");
  expect_look(Level::Warn, "usb-port /dev/hidraw0", "behind a hub (port 1-4.2)", "lsusb -t");
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
  expect_look(Level::Warn, "holder /dev/hidraw0", "but 1 processes", "sudo thimble doctor");
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

// Knows one more arm, by its descriptor alone.
class PlantedDriver : public plugin::Driver {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "planted"; }
  [[nodiscard]] Result<void> probe(const bus::BusDeviceInfo& info,
                                   const plugin::DriverSettings& settings) const override {
    if (info.kind != bus::BusKind::Hid || info.vendor_id != 0xfff0 || info.product_id != 0x6a17 ||
        info.input_report_bytes != 13 || info.output_report_bytes != 8) {
      return fail(Errc::NotMine, "");
    }
    EXPECT_EQ(info.address.text, "hid:A7");
    EXPECT_EQ(info.product, "gantry");
    EXPECT_TRUE(settings.is_named_by_person);
    return {};
  }
  [[nodiscard]] Result<std::unique_ptr<HapticDevice>> open(
      bus::BusEnumerator&, const bus::BusDeviceInfo&,
      const plugin::DriverSettings&) const override {
    ADD_FAILURE() << "doctor opens nothing";
    return fail(Errc::Unsupported, "");
  }
};

TEST_F(Doctor, LooksOnlyAtDevicesThatADriverKnows) {
  machine_.chmod("dev/hidraw0", 0666);
  EXPECT_THAT(complaints(), SizeIs(1));
  machine_.plant_ids("0000046D", "0000C077");
  EXPECT_THAT(complaints(), SizeIs(0));
  machine_.plant_ids("00001234", "00000006");
  machine_.plant_reports(8, 1);
  EXPECT_THAT(complaints(), SizeIs(0)) << "the ids are shared by the world";
  machine_.plant(PlantedMachine::kHid + "report_descriptor", "");
  EXPECT_THAT(complaints(), SizeIs(0));
}

TEST_F(Doctor, LooksAtAnArmThatAPluginKnows) {
  machine_.chmod("dev/hidraw0", 0666);
  machine_.plant_ids("0000FFF0", "00006A17");
  machine_.plant_reports(13, 8);
  machine_.plant(PlantedMachine::kUsb + "product", "gantry\n");
  EXPECT_THAT(complaints(), SizeIs(0));
  plugins_.drivers.add(std::make_unique<PlantedDriver>());
  expect_complaint(Level::Wrong, "node /dev/hidraw0", "every user may open",
                   "72-thimble-fff0-6a17.rules");
}

}  // namespace
}  // namespace thimble::doctor
