#include <sys/xattr.h>

#include "tests/unit/cli/doctor/access_list_bytes.hpp"
#include "tests/unit/cli/doctor/doctor_fixture.hpp"

// What is plugged in.
namespace thimble::doctor {
namespace {

TEST_F(Doctor, NamesAMissingDeviceNode) {
  machine_.remove("dev/hidraw0");
  expect_complaint(Level::Wrong, "node /dev/hidraw0", "is missing",
                   "echo 0 | sudo tee /sys/bus/usb/devices/1-4/authorized && echo 1 | sudo tee "
                   "/sys/bus/usb/devices/1-4/authorized");
  Facts facts = this->facts();
  facts.controllers[0].usb_port.clear();
  expect_complaint(complaints(facts), Level::Wrong, "node /dev/hidraw0", "is missing", "");
  EXPECT_EQ(complaints(facts)[0].look_with, "ls -l /dev/hidraw*");
}

TEST_F(Doctor, NamesADeviceNodeThatMayNotBeOpened) {
  for (const unsigned mode : {0600U, 0640U, 0620U}) {
    machine_.chmod("dev/hidraw0", mode);
    expect_complaint(Level::Wrong, "node /dev/hidraw0", "may not be read and written",
                     "GROUP:=\"thimble\", MODE:=\"0660\"' | sudo tee "
                     "/etc/udev/rules.d/0-thimble-1234-0006.rules && ");
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
  list.users = {{1000, 06}};
  expect_complaint(complaints(facts), Level::Wrong, "node /dev/hidraw0",
                   "lets others open /dev/hidraw0: user 1000",
                   "sudo setfacl --remove-all /dev/hidraw0; echo 'SUBSYSTEMS==");
  list = {{{1000, 0}}, {{46, 04}}, 06};
  expect_complaint(complaints(facts), Level::Wrong, "node /dev/hidraw0",
                   "lets others open /dev/hidraw0: group 46", "TAG=\"systemd\"");
  list = {{}, {}, {}, true};
  expect_complaint(complaints(facts), Level::Wrong, "node /dev/hidraw0", "cannot be read",
                   "setfacl");
}

TEST_F(Doctor, TakesTheMaskOfAListForNobodysRight) {
  // stat(2) shows rw for the group of both; only the second has it.
  for (const std::uint32_t group_rights : {0U, 06U}) {
    const auto bytes = access_list_bytes(
        {{0x01, 06}, {0x02, 0, 1000}, {0x04, group_rights}, {0x10, 06}, {0x20, 0}});
    if (::setxattr((machine_.root() / "dev/hidraw0").c_str(), "system.posix_acl_access",
                   bytes.data(), bytes.size(), 0) != 0) {
      GTEST_SKIP() << "the folder of temporary files holds no access control lists";
    }
    if (group_rights != 0) {
      EXPECT_THAT(complaints(), SizeIs(0));
    } else {
      expect_complaint(Level::Wrong, "node /dev/hidraw0", "may not be read and written",
                       "sudo setfacl --remove-all /dev/hidraw0; ");
    }
  }
}

TEST_F(Doctor, ReadsTheAccessControlListOfANode) {
  const std::vector<std::byte> bytes = access_list_bytes(kListOfASeat);
  if (::setxattr((machine_.root() / "dev/hidraw0").c_str(), "system.posix_acl_access", bytes.data(),
                 bytes.size(), 0) != 0) {
    GTEST_SKIP() << "the folder of temporary files holds no access control lists";
  }
  expect_complaint(Level::Wrong, "node /dev/hidraw0", "lets others open /dev/hidraw0: user 1000",
                   "TAG=\"systemd\"");
}

TEST_F(Doctor, NamesARawNodeThatEverybodyMayWrite) {
  machine_.chmod("dev/bus/usb/001/004", 0666);
  expect_complaint(Level::Wrong, "raw-node /dev/bus/usb/001/004",
                   "every user may write /dev/bus/usb/001/004",
                   "sudo udevadm trigger --settle --parent-match=/sys/bus/usb/devices/1-4");
  EXPECT_THAT(complaints()[0].reason, HasSubstr("take the arm from its driver"));
  machine_.chmod("dev/bus/usb/001/004", 0644);
  EXPECT_THAT(complaints(), SizeIs(0)) << "who may only read it can send nothing";
  machine_.chmod("dev/usb/hiddev0", 0604);
  expect_complaint(Level::Wrong, "raw-node /dev/usb/hiddev0",
                   "every user may open /dev/usb/hiddev0",
                   "/etc/udev/rules.d/0-thimble-1234-0006.rules");
  machine_.remove("dev/usb");
  machine_.remove("dev/bus");
  EXPECT_THAT(complaints(), SizeIs(0)) << "a container has not all of them";
}

TEST_F(Doctor, NamesARawNodeOfAnotherGroupOrPerson) {
  const Facts healthy = facts();
  Facts facts = healthy;
  Node& raw = facts.controllers[0].raw_nodes[1];
  ASSERT_EQ(raw.path, "/dev/bus/usb/001/004");
  const auto expect = [&](const std::string& finding) {
    expect_complaint(complaints(facts), Level::Wrong, "raw-node /dev/bus/usb/001/004", finding,
                     "GROUP:=\"thimble\", MODE:=\"0660\"");
    facts = healthy;
  };
  raw.group = 46;
  expect("belongs to group 46 and not to the group 'thimble'");
  raw.user = 1000;
  expect("belongs to user 1000 and not to root");
  raw.access_list.users = {{1000, 06}, {1001, 04}};
  expect("lets others write /dev/bus/usb/001/004: user 1000");
  raw.access_list.is_unreadable = true;
  expect("cannot be read");
  raw.group = 0;
  EXPECT_THAT(complaints(facts), SizeIs(0)) << "as the kernel makes it";
  raw.group = 46;
  raw.mode = 0644;
  EXPECT_THAT(complaints(facts), SizeIs(0));
}

TEST_F(Doctor, NamesALowSpeedDevice) {
  machine_.plant(PlantedMachine::kUsb + "speed", "1.5\n");
  expect_look(Level::Wrong, "usb-speed /dev/hidraw0", "low speed", "lsusb -t");
}

TEST_F(Doctor, NamesADeviceWithoutASpeed) {
  machine_.remove(PlantedMachine::kUsb + "speed");
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
  machine_.plant_process(301, "steam", "/dev/hidraw01");
  EXPECT_THAT(complaints(), SizeIs(0));
  machine_.plant_process(300, "steam", "/dev/hidraw0");
  machine_.plant_user(300, 1000);
  expect_complaint(Level::Wrong, "holder /dev/hidraw0",
                   "held by 'steam' (process 300 of user 'mallory')", "sudo kill 300");
  EXPECT_EQ(complaints()[0].look_with, "systemctl status 300");
  for (const char* node : {"/dev/bus/usb/001/004", "/dev/usb/hiddev0"}) {
    machine_.plant_process(300, "steam", node);
    expect_complaint(Level::Wrong, "holder /dev/hidraw0", "held by 'steam'", "sudo kill 300");
  }
}

TEST_F(Doctor, ForgivesAHolderByItsProgramAndItsAccountAndNeverByItsName) {
  machine_.plant_process(300, "thimble-guard", "/dev/hidraw0");
  machine_.plant_user(300, 64000);
  expect_complaint(Level::Wrong, "holder /dev/hidraw0", "held by 'thimble-guard' (process 300",
                   "sudo kill 300");
  machine_.run_program(300, "usr/bin/steam");
  EXPECT_THAT(complaints(), SizeIs(1)) << "some other program";
  machine_.run_program(300, "usr/bin/thimble-guard");
  EXPECT_THAT(complaints(), SizeIs(0)) << "the guard, under the account of the daemon";
  machine_.plant_user(300, 0);
  EXPECT_THAT(complaints(), SizeIs(0)) << "or root's";
  machine_.plant_user(300, 1000);
  EXPECT_THAT(complaints(), SizeIs(1)) << "anybody may start the guard's program";
  const std::string unit = "thimble-guard@0-77-64000.service";
  machine_.plant("proc/300/cgroup", "0::/user.slice/user-1000.slice/user@1000.service/" + unit);
  EXPECT_THAT(complaints(), SizeIs(1)) << "and have a unit of that name";
  machine_.plant("proc/300/cgroup", "0::/system.slice/system-thimble\\x2dguard.slice/" + unit);
  EXPECT_THAT(complaints(), SizeIs(0)) << "but not one of the system";
}

TEST_F(Doctor, NamesASecondDaemonThatHoldsTheDevice) {
  machine_.plant_process(300, "thimbled", "/dev/hidraw0");
  machine_.plant_user(300, 1000);
  machine_.run_program(300, "usr/bin/thimbled");
  expect_complaint(Level::Wrong, "holder /dev/hidraw0",
                   "'thimbled' (process 300 of user 'mallory')", "sudo kill 300");
}

TEST_F(Doctor, NeverSignalsTheFirstProcess) {
  machine_.plant_process(1, "systemd", "/dev/hidraw0");
  machine_.plant_user(1, 0);
  expect_look(Level::Wrong, "holder /dev/hidraw0", "'systemd' (process 1 of user 'root')",
              "systemctl status 1");
}

TEST_F(Doctor, SaysThatItMayHaveOverlookedAHolder) {
  machine_.plant("proc/2/comm", "kthreadd\n");
  machine_.plant("proc/2/status", "Name:\tkthreadd\nUid:\t0\t0\t0\t0\n");
  machine_.plant("proc/3/status", "");
  EXPECT_THAT(complaints(), SizeIs(0)) << "a thread of the kernel, and a process that has ended";
  machine_.plant("proc/1/comm", "systemd\n");  // and no fd that could be read
  machine_.plant_user(1, 0);
  expect_look(Level::Warn, "holder /dev/hidraw0", "but 1 processes", "sudo thimble doctor");
}

TEST_F(Doctor, LooksAtAnArmOnBareUsb) {
  machine_.plant_falcon();
  Facts facts = this->facts();
  ASSERT_THAT(facts.controllers, SizeIs(2));
  EXPECT_EQ(facts.controllers[0].address, "hid:A7");
  EXPECT_EQ(facts.controllers[1].address, "usb:pci-0000:00:14.0-usb-0:5");
  EXPECT_THAT(complaints(facts), SizeIs(0));
  machine_.plant("sys/devices/pci0000:00/0000:00:14.0/usb1/1-5/serial", "FA1CON\n");
  EXPECT_EQ(this->facts().controllers.at(1).address, "usb:FA1CON") << "as the bus names it";
  machine_.chmod("dev/bus/usb/001/009", 0666);
  expect_complaint(Level::Wrong, "node /dev/bus/usb/001/009",
                   "every user may write /dev/bus/usb/001/009",
                   "/etc/udev/rules.d/0-thimble-0403-cb48.rules");
  machine_.chmod("dev/bus/usb/001/009", 0644);
  expect_complaint(Level::Wrong, "node /dev/bus/usb/001/009",
                   "may not be read and written by the daemon",
                   "--parent-match=/sys/bus/usb/devices/1-5");
  machine_.plant("sys/devices/pci0000:00/0000:00:14.0/usb1/1-5/1-5:1.0/ep_81/wMaxPacketSize",
                 "0008\n");
  EXPECT_THAT(complaints(), SizeIs(0)) << "another device with these ids";
}

TEST_F(Doctor, LooksAtAnArmOnASerialPortAndAtNoOtherTerminal) {
  machine_.plant_teensy();
  const Facts facts = this->facts();
  ASSERT_THAT(facts.controllers, SizeIs(2));
  EXPECT_EQ(facts.controllers[1].address, "serial:1234567");
  EXPECT_EQ(facts.controllers[1].node.path, "/dev/ttyACM0");
  EXPECT_EQ(facts.controllers[1].usb_port, "1-6");
  EXPECT_THAT(complaints(facts), SizeIs(0));
  machine_.chmod("dev/ttyACM0", 0666);
  expect_complaint(Level::Wrong, "node /dev/ttyACM0", "every user may open",
                   "/etc/udev/rules.d/0-thimble-16c0-0483.rules");
  machine_.chmod("dev/ttyACM0", 0640);
  expect_complaint(Level::Wrong, "node /dev/ttyACM0", "may not be read and written by the daemon",
                   "--parent-match=/sys/bus/usb/devices/1-6");
  machine_.chmod("dev/ttyACM0", 0660);
  machine_.chmod("dev/bus/usb/001/010", 0666);
  expect_complaint(Level::Wrong, "raw-node /dev/bus/usb/001/010", "every user may write",
                   "/etc/udev/rules.d/0-thimble-16c0-0483.rules");
}

TEST_F(Doctor, SaysWhichArmOfTheConfigurationIsNotThere) {
  config::Config config;
  config.arms.resize(3);
  config.arms[0].name = "right";
  config.arms[0].device = facts().controllers.at(0).address;
  config.arms[1].name = "left";
  config.arms[1].device = "hid:NOBODY";
  config.arms[2].device = "sim:phantom-vintage";  // is always there
  Facts facts = this->facts(config);
  ASSERT_THAT(facts.configured_arms, SizeIs(2));
  EXPECT_EQ(check_configured_arm(facts, facts.configured_arms[0]).level, Level::Ok);
  expect_one(complaints(facts), Level::Warn, "arm left", "is at hid:NOBODY");
  facts.controllers.clear();
  EXPECT_THAT(complaints(facts), SizeIs(2));
}

TEST_F(Doctor, SaysHowWhatIsInThePortOfAnOlderConfigurationIsCalledNow) {
  config::Config config;
  config.arms.resize(1);
  config.arms[0].device = "hid:1-4";
  const Facts facts = this->facts(config);
  const Verdict verdict = check_configured_arm(facts, facts.configured_arms.at(0));
  EXPECT_EQ(verdict.level, Level::Warn);
  EXPECT_THAT(
      verdict.advice,
      testing::EndsWith(
          "what the kernel calls so today is hid:A7, which may be another one than was meant"));
}

// Knows one more arm, by its descriptor alone.
class PlantedDriver : public plugin::Driver {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "planted"; }
  [[nodiscard]] std::vector<std::string> models() const override { return {}; }
  [[nodiscard]] Result<void> check_files(
      const plugin::DriverSettings& /*it reads none*/) const override {
    return {};
  }
  [[nodiscard]] Result<void> probe(const bus::BusDeviceInfo& info,
                                   const plugin::DriverSettings& settings) const override {
    if (info.kind != bus::BusKind::Hid || info.vendor_id != 0xfff0 || info.product_id != 0x6a17 ||
        info.input_report_bytes != 13 || info.output_report_bytes != 8) {
      return fail(Errc::NotMine, "");
    }
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
                   "0-thimble-fff0-6a17.rules");
}

// What is behind a dongle is in no port of its own, and the dongle's nodes are not its.
TEST_F(Doctor, TakesNoDongleForTheArmBehindIt) {
  ASSERT_EQ(facts().controllers.at(0).usb_port, "1-4");
  ASSERT_THAT(facts().controllers[0].raw_nodes, SizeIs(2));
  const auto expect_no_usb = [&](const char* why) {
    const Facts found = facts();
    ASSERT_THAT(found.controllers, SizeIs(1)) << why;
    EXPECT_EQ(found.controllers[0].node.path, "/dev/hidraw0") << why;
    EXPECT_EQ(found.controllers[0].usb_port, "") << why;
    EXPECT_EQ(found.controllers[0].power_control, "") << why;
    EXPECT_THAT(found.controllers[0].raw_nodes, SizeIs(0)) << why;
    expect_one(complaints(found), Level::Warn, "usb-speed /dev/hidraw0", "not known");
  };
  for (const char* bus : {"0005", "0006", "0018", "0000"}) {
    machine_.plant_hid_ids(bus, "00001234", "00000006");
    expect_no_usb(bus);
  }
  machine_.plant_ids("00001234", "00000006");
  for (const char* file : {"idVendor", "idProduct"}) {
    machine_.plant(PlantedMachine::kUsb + file, "c52b\n");
    expect_no_usb(file);
    machine_.remove(PlantedMachine::kUsb + file);
    expect_no_usb(file);
    machine_.plant_ids("00001234", "00000006");
  }
  EXPECT_EQ(facts().controllers.at(0).usb_port, "1-4");
}

}  // namespace
}  // namespace thimble::doctor
