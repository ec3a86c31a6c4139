#include <filesystem>

#include "tests/unit/cli/doctor/doctor_fixture.hpp"

// How arms that are plugged in are called.
namespace thimble::doctor {
namespace {

class DoctorNames : public Doctor {
 protected:
  [[nodiscard]] std::vector<std::string> addresses() const {
    std::vector<std::string> all;
    for (const Controller& controller : facts().controllers) all.push_back(controller.address);
    return all;
  }
  // One like it, number and all, at another port.
  void plant_twin() const {
    const std::filesystem::path bus = machine_.root() / "sys/devices/pci0000:00/0000:00:14.0/usb1";
    std::filesystem::copy(
        bus / "1-4", bus / "1-7",
        std::filesystem::copy_options::recursive | std::filesystem::copy_options::copy_symlinks);
    link("hidraw1", "pci0000:00/0000:00:14.0/usb1/1-7/1-4:1.0/0003:1234:0006.0001/hidraw/hidraw0");
  }
  // As of uhid, on no USB.
  void plant_virtual() const {
    const std::string hid = "virtual/misc/uhid/0005:1234:0006.0009/";
    machine_.plant("sys/devices/" + hid + "uevent", "HID_ID=0005:00001234:00000006\nHID_UNIQ=\n");
    std::filesystem::copy(machine_.root() / PlantedMachine::kHid / "report_descriptor",
                          machine_.root() / "sys/devices" / hid / "report_descriptor");
    machine_.plant("sys/devices/" + hid + "hidraw/hidraw2/dev", "243:2\n");
    std::filesystem::create_symlink(
        "../..", machine_.root() / "sys/devices" / hid / "hidraw/hidraw2/device");
    link("hidraw2", hid + "hidraw/hidraw2");
  }

 private:
  void link(const std::string& node, const std::string& device) const {
    std::filesystem::create_symlink("../../devices/" + device,
                                    machine_.root() / "sys/class/hidraw" / node);
  }
};

// What a configuration may name it by, and the daemon will.
TEST_F(DoctorNames, AnArmAsTheDaemonDoes) {
  EXPECT_THAT(addresses(), testing::ElementsAre("hid:A7"));
  machine_.plant(PlantedMachine::kUsb + "serial", "B8\n");
  EXPECT_THAT(addresses(), testing::ElementsAre("hid:B8")) << "the USB device's own goes first";
  for (const char* unusable : {"B 8\n", "\x1b[2J\n", "1-4.2\n"}) {
    machine_.plant(PlantedMachine::kUsb + "serial", unusable);
    EXPECT_THAT(addresses(), testing::ElementsAre("hid:pci-0000:00:14.0-usb-0:4")) << unusable;
  }
  machine_.plant(PlantedMachine::kUsb + "1-4:1.0/bInterfaceNumber", "02\n");
  EXPECT_THAT(addresses(), testing::ElementsAre("hid:pci-0000:00:14.0-usb-0:4:1.2"));
}

TEST_F(DoctorNames, TwoArmsOfOneNumberByTheirPorts) {
  plant_twin();
  EXPECT_THAT(addresses(),
              testing::ElementsAre("hid:pci-0000:00:14.0-usb-0:4", "hid:pci-0000:00:14.0-usb-0:7"));
}

TEST_F(DoctorNames, AnArmOfASuperSpeedHalfAsTheDaemonDoes) {
  machine_.plant(PlantedMachine::kUsb + "serial", "");
  machine_.plant(PlantedMachine::kUsb + "1-4:1.0/0003:1234:0006.0001/uevent",
                 "HID_ID=0003:00001234:00000006\n");
  machine_.plant("sys/devices/pci0000:00/0000:00:14.0/usb1/version", " 3.00\n");
  EXPECT_THAT(addresses(), testing::ElementsAre("hid:pci-0000:00:14.0-usbv3-0:4"));
}

TEST_F(DoctorNames, AnArmOnNoUsbAsTheKernelCallsIt) {
  plant_virtual();
  EXPECT_THAT(addresses(), testing::ElementsAre("hid:A7", "hid:0005:1234:0006.0009"));
}

}  // namespace
}  // namespace thimble::doctor
