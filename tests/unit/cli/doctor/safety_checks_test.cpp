#include "tests/support/fake_libgpiod.hpp"
#include "tests/unit/cli/doctor/doctor_fixture.hpp"

// The chip and the lines of [safety]: libgpiod is a stand-in, the files are planted.
namespace thimble::doctor {
namespace {

class DoctorSafety : public Doctor {
 protected:
  DoctorSafety() {
    safety_.chip = "cp2112_gpio";
    safety_.estop = {"0", "1"};
    safety_.deadman = "HOLD";
    safety_.enable = "3";
    safety_.lamp = "4";
    machine_.chmod("dev/gpiochip1", 0660);
    machine_.plant("sys/devices/usb1/1-3/0003:10C4:EA90.0007/gpiochip1/dev", "254:1\n");
    std::filesystem::create_directories(machine_.root() / "sys/bus/gpio/devices");
    std::filesystem::create_symlink("../../../devices/usb1/1-3/0003:10C4:EA90.0007/gpiochip1",
                                    machine_.root() / "sys/bus/gpio/devices/gpiochip1");
  }
  ~DoctorSafety() override { EXPECT_EQ(test::FakeGpioChip::alive(), 0); }

  [[nodiscard]] Facts facts() const {
    config::Config config;
    config.safety = safety_;
    return Doctor::facts(config);
  }
  [[nodiscard]] std::vector<Verdict> complaints() const { return Doctor::complaints(facts()); }
  void expect(const std::string& check, const std::string& finding, const std::string& command,
              const std::string& look_with) const {
    const std::vector<Verdict> all = complaints();
    expect_complaint(all, Level::Wrong, check, finding, command);
    if (all.size() != 1) return;
    EXPECT_EQ(all[0].command.empty(), command.empty());
    EXPECT_THAT(all[0].look_with, HasSubstr(look_with));
    EXPECT_NE(all[0].advice, "");
  }
  [[nodiscard]] std::string node(int number) const {
    return (machine_.root() / "dev" / ("gpiochip" + std::to_string(number))).string();
  }

  config::SafetyConfig safety_;
  test::FakeGpioChip board_{node(0), "board", {"a", "b"}};
  test::FakeGpioChip chip_{node(1), "cp2112_gpio", {"", "", "HOLD", "", ""}};
};

TEST_F(DoctorSafety, FindsChipAndLinesThatAreFree) {
  EXPECT_THAT(complaints(), SizeIs(0));
  const std::vector<Verdict> all = examine(facts());
  ASSERT_THAT(all, SizeIs(22));
  EXPECT_THAT(all[16].finding, HasSubstr("/dev/gpiochip1 is 'cp2112_gpio'"));
  EXPECT_EQ(all[21].check, "safety-line 4");
  EXPECT_EQ(all[21].finding, "it is there for safety.lamp, nobody has it");
}

TEST_F(DoctorSafety, AnotherNameOfAChipIsNoSecondOne) {
  std::filesystem::create_symlink("gpiochip1", machine_.root() / "dev/gpiochip4");
  EXPECT_THAT(complaints(), SizeIs(0));
  EXPECT_THAT(facts().gpio_chips, SizeIs(2));
}

TEST_F(DoctorSafety, OpensNoChipThatNoConfigurationAsksFor) {
  EXPECT_THAT(Doctor::facts().gpio_chips, SizeIs(0));
  safety_.chip = "sim:bench";
  EXPECT_THAT(complaints(), SizeIs(0)) << "a simulated one has all lines";
}

TEST_F(DoctorSafety, NamesAChipThatIsNotThere) {
  safety_.chip = "soc";
  expect("safety-chip", "label 'soc'; there is: 'board', 'cp2112_gpio'", "", "gpiodetect");
  safety_.chip = "cp2112_gpio";
  chip_.unplug();
  expect("safety-chip", "there is: 'board'", "sudo modprobe hid-cp2112", "gpiodetect");
}

TEST_F(DoctorSafety, NamesChipsThatMayNotBeLookedAt) {
  chip_.forbid(true);
  const std::vector<Verdict> all = complaints();
  expect_one(all, Level::Warn, "safety-chip", "but /dev/gpiochip1 could not be looked at");
  EXPECT_EQ(all.at(0).look_with, "sudo gpiodetect");
}

TEST_F(DoctorSafety, NamesTwoChipsOfOneLabel) {
  const test::FakeGpioChip twin(node(2), "cp2112_gpio", {"", "", "HOLD", "", ""});
  expect("safety-chip", "/dev/gpiochip1 and /dev/gpiochip2 both have the label", "", "gpiodetect");
}

// A chip at a cable says its label itself.
TEST_F(DoctorSafety, TakesWordsOfAChipThatSteerATerminalForNone) {
  const test::FakeGpioChip rogue(node(2), "soc\n\x1b[2J", {"a\x07"});
  safety_.chip = "none";
  const Facts all = facts();
  ASSERT_THAT(all.gpio_chips, SizeIs(3));
  EXPECT_EQ(all.gpio_chips[2].label, "soc??[2J");
  EXPECT_EQ(all.gpio_chips[2].lines.at(0).name, "a?");
}

TEST_F(DoctorSafety, NamesAChipThatTheDaemonMayNotOpen) {
  const std::string apply =
      "GROUP=\"thimble\", MODE=\"0660\"' | sudo tee /etc/udev/rules.d/99-thimble-gpio.rules && "
      "sudo udevadm control --reload && sudo udevadm trigger --settle /dev/gpiochip1";
  for (const unsigned mode : {0600U, 0640U, 0620U}) {
    machine_.chmod("dev/gpiochip1", mode);
    expect("safety-chip", "/dev/gpiochip1 may not be read and written by the daemon",
           "echo 'SUBSYSTEM==\"gpio\", KERNELS==\"*:10C4:EA90.*\", " + apply, "");
  }
  machine_.remove("sys/bus/gpio");
  expect("safety-chip", "may not be read and written", "KERNEL==\"gpiochip1\", " + apply, "");
}

TEST_F(DoctorSafety, NamesAChipOfTheBoardByItsDevice) {
  safety_ = {};
  safety_.chip = "board";
  safety_.estop = {"a"};
  machine_.chmod("dev/gpiochip0", 0600);
  for (const std::string device : {"INT33FC:00", "0000:00:1f.0"}) {
    machine_.plant("sys/devices/platform/" + device + "/gpiochip0/dev", "254:0\n");
    std::filesystem::create_symlink("../../../devices/platform/" + device + "/gpiochip0",
                                    machine_.root() / "sys/bus/gpio/devices/gpiochip0");
    expect("safety-chip", "/dev/gpiochip0 may not", "KERNELS==\"" + device + "\", GROUP", "");
    machine_.remove("sys/bus/gpio/devices/gpiochip0");
  }
}

TEST_F(DoctorSafety, NamesALineThatTheChipDoesNotHave) {
  safety_.enable = "5";
  expect("safety-line 5", "no line '5' for safety.enable; it has 5", "", "gpioinfo cp2112_gpio");
  safety_.enable = "ENABLE";
  expect("safety-line ENABLE", "no line 'ENABLE' for safety.enable", "", "gpioinfo");
  safety_.enable = "99999999999999999999999";
  expect("safety-line " + *safety_.enable, "no line '9", "", "gpioinfo");
}

TEST_F(DoctorSafety, NamesALineThatAnotherProgramHas) {
  chip_.take(2, "gpiomon");
  expect("safety-line HOLD", "for safety.deadman is taken by 'gpiomon'", "",
         "gpioinfo cp2112_gpio");
  machine_.plant_process(300, "gpiomon", "/dev/gpiochip1");
  machine_.plant_user(300, 1000);
  expect("safety-line HOLD", "'gpiomon' (process 300 of user 'mallory') has the chip open",
         "sudo kill 300", "systemctl status 300");
}

TEST_F(DoctorSafety, NamesALineThatTheKernelHas) {
  chip_.take(0, "");
  expect("safety-line 0", "for safety.estop is taken by somebody", "", "gpioinfo cp2112_gpio");
}

TEST_F(DoctorSafety, ForgivesTheDaemonItsOwnLinesAndNobodyWhoTakesItsName) {
  for (std::size_t line = 0; line < 5; ++line) chip_.take(line, "thimbled");
  machine_.plant_process(77, "thimbled", "/dev/gpiochip1");
  EXPECT_THAT(complaints(), SizeIs(0));
  machine_.plant_process(77, "thimbled", "/dev/hidraw0");
  EXPECT_THAT(complaints(), SizeIs(5)) << "it has not opened the chip";
  machine_.remove("proc/77/fd");
  machine_.plant_user(77, 64000);
  Facts hidden = facts();
  ASSERT_EQ(hidden.hidden_processes, 1U);
  const auto about_lines = [](const Verdict& verdict) {
    return verdict.level != Level::Ok && verdict.check.starts_with("safety-line");
  };
  std::vector<Verdict> all = examine(hidden);
  EXPECT_EQ(std::count_if(all.begin(), all.end(), about_lines), 0) << "who knows";
  hidden.process.known_by = KnownBy::Nothing;
  all = examine(hidden);
  ASSERT_EQ(std::count_if(all.begin(), all.end(), about_lines), 5) << "no daemon runs";
  EXPECT_THAT(all.back().look_with, HasSubstr("sudo fuser -v /dev/gpiochip1"));
}

}  // namespace
}  // namespace thimble::doctor
