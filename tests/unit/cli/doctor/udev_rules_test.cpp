#include "cli/doctor/udev_rules.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/unit/cli/doctor/udev_oracle.hpp"

namespace thimble::doctor {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::map<std::string, std::string> kUsbDevice{{"KERNEL", "1-4"},
                                                    {"SUBSYSTEM", "usb"},
                                                    {"ATTR{idVendor}", "16c0"},
                                                    {"ATTR{idProduct}", "0486"}};
const std::map<std::string, std::string> kInterface{{"KERNEL", "1-4:1.0"}, {"SUBSYSTEM", "usb"}};
const std::map<std::string, std::string> kHid{{"KERNEL", "0003:16C0:0486.0001"},
                                              {"SUBSYSTEM", "hid"}};
const std::map<std::string, std::string> kRootHub{{"KERNEL", "usb1"},
                                                  {"SUBSYSTEM", "usb"},
                                                  {"ATTR{idVendor}", "1d6b"},
                                                  {"ATTR{idProduct}", "0002"}};

// The three nodes by which an arm of USB may be commanded.
std::vector<UdevDevice> nodes() {
  return {
      {{{"KERNEL", "hidraw0"}, {"SUBSYSTEM", "hidraw"}}, kHid, kInterface, kUsbDevice, kRootHub},
      {{{"KERNEL", "hiddev0"}, {"SUBSYSTEM", "usbmisc"}}, kInterface, kUsbDevice, kRootHub},
      {kUsbDevice, kRootHub}};
}

Controller arm() {
  Controller controller;
  controller.node.path = "/dev/hidraw0";
  controller.vendor_id = 0x16c0;
  controller.product_id = 0x0486;
  controller.usb_port = "1-4";
  return controller;
}

void add(const std::vector<UdevRules>& rules, UdevFiles& files) {
  for (const UdevRules& one : rules) files[one.file].push_back(one.line);
}

void expect_closed(const UdevFiles& files, const UdevDevice& device) {
  const UdevNode node = udev_apply(files, device);
  EXPECT_EQ(node.keys.at("OWNER"), "root");
  EXPECT_EQ(node.keys.at("GROUP"), "thimble");
  EXPECT_EQ(node.keys.at("MODE"), "0660");
  EXPECT_FALSE(node.is_open_to_the_seat);
}

// What PJRC gives with its boards, as their users install it.
const UdevFiles kRulesOfTheBoard{
    {"00-teensy.rules",
     {R"(KERNEL=="hidraw*", ATTRS{idVendor}=="16c0", ATTRS{idProduct}=="04*", MODE:="0666")",
      R"(SUBSYSTEMS=="usb", ATTRS{idVendor}=="16c0", ATTRS{idProduct}=="04*", MODE:="0666")"}}};

TEST(UdevRules, CloseEveryNodeThatTheRulesOfTheBoardOpenFinally) {
  for (const UdevDevice& device : nodes()) {
    UdevFiles files = kRulesOfTheBoard;
    EXPECT_EQ(udev_apply(files, device).keys.at("MODE"), "0666");
    add(closing_rules(arm()), files);
    expect_closed(files, device);
  }
}

TEST(UdevRules, WouldLoseWithLess) {
  UdevFiles files = kRulesOfTheBoard;
  files["72-thimble.rules"] = {closing_rules(arm()).at(0).line};
  EXPECT_EQ(udev_apply(files, nodes()[0]).keys.at("MODE"), "0666") << "the oracle knows ':='";
  files = {{"70-local.rules", {R"(KERNEL=="hidraw*", TAG+="uaccess")"}},
           {"72-thimble.rules", {R"(KERNEL=="hidraw*", TAG-="uaccess")"}}};
  EXPECT_TRUE(udev_apply(files, nodes()[0]).is_open_to_the_seat);
}

TEST(UdevRules, WinAgainstWhateverOthersSay) {
  const std::vector<std::string> names{"00-0.rules",    "00-teensy.rules", "49-teensy.rules",
                                       "50-udev.rules", "70-local.rules",  "73-seat-a.rules",
                                       "73-0.rules",    "72-zz.rules",     "99-hid.rules"};
  const std::vector<std::string> matches{R"(KERNEL=="hidraw*")", R"(SUBSYSTEMS=="usb")",
                                         R"(ATTRS{idVendor}=="16c0")", R"(SUBSYSTEM=="usb*")",
                                         R"(KERNELS=="*:16C0:*")"};
  const std::vector<std::string> assignments{R"(MODE="0666")",     R"(MODE:="0666")",
                                             R"(GROUP="plugdev")", R"(GROUP:="plugdev")",
                                             R"(OWNER:="lab")",    R"(TAG+="uaccess")"};
  std::mt19937 random(242);
  const auto pick = [&](const std::vector<std::string>& from) {
    return from[random() % from.size()];
  };
  int opened = 0;
  for (int round = 0; round < 300; ++round) {
    UdevFiles files;
    for (int i = 0; i < 6; ++i) {
      files[pick(names)].push_back(pick(matches) + ", " + pick(assignments));
    }
    for (const UdevDevice& device : nodes()) {
      const UdevNode others = udev_apply(files, device);
      opened += others.is_open_to_the_seat || others.keys.at("MODE") == "0666" ? 1 : 0;
      UdevFiles all = files;
      add(closing_rules(arm()), all);
      expect_closed(all, device);
    }
  }
  EXPECT_GT(opened, 300) << "there was something to win against";
}

TEST(UdevRules, LeaveOtherDevicesAlone) {
  UdevFiles files;
  add(closing_rules(arm()), files);
  auto mouse = nodes();
  for (UdevDevice& device : mouse) {
    for (auto& parent : device) {
      if (parent.contains("ATTR{idProduct}")) parent["ATTR{idProduct}"] = "c077";
    }
    EXPECT_EQ(udev_apply(files, device).keys.at("GROUP"), "root");
  }
}

TEST(UdevRules, CloseAnArmThatIsOfNoUsb) {
  Controller controller = arm();
  controller.usb_port.clear();
  UdevFiles files{{"70-local.rules", {R"(KERNEL=="hidraw*", MODE="0666", TAG+="uaccess")"}}};
  add(closing_rules(controller), files);
  UdevDevice device = nodes()[0];
  device.resize(2);
  device[1]["KERNEL"] = "0005:16C0:0486.0001";
  expect_closed(files, device);
  EXPECT_THAT(closing_command(controller),
              testing::EndsWith("udevadm trigger --settle /dev/hidraw0"));
}

TEST(UdevRules, AreWrittenByACommandThatMayBeTypedTwice) {
  const std::string command = closing_command(arm());
  for (const UdevRules& rules : closing_rules(arm())) {
    EXPECT_THAT(command, HasSubstr("echo '" + rules.line + "' | sudo tee /etc/udev/rules.d/" +
                                   rules.file + " && "));
    EXPECT_EQ(rules.line.find('\''), std::string::npos);
  }
  EXPECT_THAT(command,
              testing::EndsWith("sudo udevadm control --reload && sudo udevadm trigger --settle "
                                "--parent-match=/sys/bus/usb/devices/1-4"));
  EXPECT_THAT(rules_that_speak_of(arm()), HasSubstr("grep -rils -e 16c0 -e hidraw -e uaccess "));
}

}  // namespace
}  // namespace thimble::doctor
