#pragma once

#include <sys/stat.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>

#include "tests/support/temporary_folder.hpp"

namespace thimble::doctor {

// A machine with one arm where all is well, as files in a temporary folder.
class PlantedMachine {
 public:
  PlantedMachine() {
    plant("proc/sys/kernel/osrelease", "6.1.0-50-rt-amd64\n");
    plant("proc/sys/kernel/version", "#1 SMP PREEMPT_RT Debian 6.1.176-1\n");
    plant("proc/sys/kernel/sched_rt_runtime_us", "950000\n");
    plant("proc/sys/kernel/sched_rt_period_us", "1000000\n");
    plant("sys/kernel/realtime", "1\n");
    plant("sys/devices/system/cpu/cpuidle/current_driver", "intel_idle\n");
    plant(kClock + "current_clocksource", "tsc\n");
    plant(kClock + "available_clocksource", "tsc hpet acpi_pm \n");
    for (const char* cpu : {"cpu0", "cpu1"}) plant_governor(cpu, "performance");
    plant("sys/devices/system/cpu/cpufreq/boost", "1\n");
    plant_daemon();
    plant_arm();
  }

  [[nodiscard]] const std::filesystem::path& root() const { return root_; }

  void plant(const std::string& path, const std::string& text) const { folder_.write(path, text); }
  void remove(const std::string& path) const { std::filesystem::remove_all(root_ / path); }
  void chmod(const std::string& path, unsigned mode) const {
    ::chmod((root_ / path).c_str(), static_cast<mode_t>(mode));
  }

  void plant_governor(const std::string& cpu, const std::string& governor) const {
    plant("sys/devices/system/cpu/" + cpu + "/cpufreq/scaling_governor", governor + "\n");
  }
  // A daemon of some other user than the files', in the given groups.
  void plant_status(const std::string& groups) const {
    plant("proc/77/status",
          "Name:\tthimbled\nUid:\t64000\t64000\t64000\t64000\n"
          "Gid:\t64001\t64001\t64001\t64001\nGroups:\t" +
              groups + " \nCapEff:\t0000000000000000\n");
  }
  // As a service of systemd; else the daemon runs in a login session.
  void plant_service(const std::string& unit) const {
    plant("proc/77/cgroup", "0::/system.slice/" + unit + "\n");
  }
  void plant_limits(const std::string& rtprio, const std::string& memlock) const {
    plant("proc/77/limits",
          "Limit                     Soft Limit           Hard Limit           Units     \n"
          "Max locked memory         65536                " +
              memlock + "            bytes     \nMax realtime priority     " + rtprio +
              "                   " + rtprio + "                   \n");
  }
  // What the arm says its reports are: that many bytes each way.
  void plant_reports(char input_bytes, char output_bytes) const {
    using std::string_literals::operator""s;
    plant(kHid + "report_descriptor", "\x06\x00\xff\x09\x01\xa1\x01\x75\x08\x95"s + input_bytes +
                                          "\x81\x02\x95" + output_bytes + "\x91\x02\xc0");
  }
  void plant_ids(const std::string& vendor, const std::string& product) const {
    plant_hid_ids("0003", vendor, product);
    plant(kUsb + "idVendor", vendor.substr(4) + "\n");
    plant(kUsb + "idProduct", product.substr(4) + "\n");
  }
  // Of the HID device only, on any bus: 0003 is USB, 0005 Bluetooth (linux/input.h).
  void plant_hid_ids(const std::string& bus, const std::string& vendor,
                     const std::string& product) const {
    plant(kHid + "uevent",
          "DRIVER=hid-generic\nHID_ID=" + bus + ":" + vendor + ":" + product +
              "\nHID_NAME=mbed\nHID_PHYS=usb-0000:00:14.0-4/input0\nHID_UNIQ=A7\n");
  }
  void plant_process(int pid, const std::string& name, const std::string& open_file) const {
    const std::filesystem::path folder = root_ / "proc" / std::to_string(pid);
    plant("proc/" + std::to_string(pid) + "/comm", name + "\n");
    std::filesystem::create_directories(folder / "fd");
    std::filesystem::remove(folder / "fd/3");
    std::filesystem::create_symlink(open_file, folder / "fd/3");
  }
  // A Falcon in port 1-5, without HID.
  void plant_falcon() const {
    const std::string usb = "sys/devices/pci0000:00/0000:00:14.0/usb1/1-5/";
    for (const auto& [file, text] : {std::pair{"idVendor", "0403"},
                                     {"idProduct", "cb48"},
                                     {"busnum", "1"},
                                     {"devnum", "9"},
                                     {"speed", "12"},
                                     {"power/control", "on"},
                                     {"1-5:1.0/bInterfaceNumber", "00"},
                                     {"1-5:1.0/ep_81/bEndpointAddress", "81"},
                                     {"1-5:1.0/ep_81/bmAttributes", "02"},
                                     {"1-5:1.0/ep_81/wMaxPacketSize", "0040"},
                                     {"1-5:1.0/ep_81/bInterval", "00"},
                                     {"1-5:1.0/ep_02/bEndpointAddress", "02"},
                                     {"1-5:1.0/ep_02/bmAttributes", "02"},
                                     {"1-5:1.0/ep_02/wMaxPacketSize", "0040"},
                                     {"1-5:1.0/ep_02/bInterval", "00"}}) {
      plant(usb + file, std::string(text) + "\n");
    }
    const std::filesystem::path link = root_ / "sys/bus/usb/devices/1-5";
    std::filesystem::create_directories(link.parent_path());
    std::filesystem::create_symlink("../../../devices/pci0000:00/0000:00:14.0/usb1/1-5", link);
    plant_node("dev/bus/usb/001/009", 0660);
  }
  // A Teensy in port 1-6 that is a serial port, and a terminal of the machine's own.
  void plant_teensy() const {
    const std::string usb = "sys/devices/pci0000:00/0000:00:14.0/usb1/1-6/";
    for (const auto& [file, text] : {std::pair{"idVendor", "16c0"},
                                     {"idProduct", "0483"},
                                     {"serial", "1234567"},
                                     {"busnum", "1"},
                                     {"devnum", "10"},
                                     {"speed", "480"},
                                     {"power/control", "on"},
                                     {"1-6:1.0/bInterfaceNumber", "00"},
                                     {"1-6:1.0/tty/ttyACM0/dev", "166:0"}}) {
      plant(usb + file, std::string(text) + "\n");
    }
    plant("sys/devices/platform/serial8250/tty/ttyS0/dev", "4:64\n");
    const std::filesystem::path links = root_ / "sys/class/tty";
    std::filesystem::create_directories(links);
    std::filesystem::create_symlink(
        "../../devices/pci0000:00/0000:00:14.0/usb1/1-6/1-6:1.0/tty/ttyACM0", links / "ttyACM0");
    std::filesystem::create_symlink("../../devices/platform/serial8250/tty/ttyS0", links / "ttyS0");
    plant_node("dev/ttyACM0", 0660);
    plant_node("dev/ttyS0", 0666);
    plant_node("dev/bus/usb/001/010", 0660);
  }
  // What a process runs, as /proc/PID/exe shows it.
  void run_program(int pid, const std::string& program) const {
    const std::filesystem::path link = root_ / "proc" / std::to_string(pid) / "exe";
    std::filesystem::remove(link);
    std::filesystem::create_symlink("../../" + program, link);
  }
  void plant_user(int pid, unsigned user) const {
    const std::string number = std::to_string(user);
    plant("proc/" + std::to_string(pid) + "/status", "Name:\tx\nUid:\t" + number + "\t" + number +
                                                         "\t" + number + "\t" + number +
                                                         "\nGid:\t1\t1\t1\t1\nVmSize:\t8 kB\n");
  }
  // The group 'thimble'. The files are this program's own: the tests give them away.
  static constexpr std::uint32_t kThimble = 4242;
  [[nodiscard]] static std::string group() { return std::to_string(kThimble); }

  static inline const std::string kUsb = "sys/devices/pci0000:00/0000:00:14.0/usb1/1-4/";
  static inline const std::string kHid = kUsb + "1-4:1.0/0003:1234:0006.0001/";
  static inline const std::string kClock = "sys/devices/system/clocksource/clocksource0/";

  // Moves the arm to another port: "1-4" is where it is at first.
  void replug(const std::string& port) const {
    const std::filesystem::path bus = root_ / "sys/devices/pci0000:00/0000:00:14.0/usb1";
    std::filesystem::rename(bus / "1-4", bus / port);
    link_hidraw(port);
  }

 private:
  void plant_daemon() const {
    plant("etc/group", "root:x:0:\nthimbles:x:5:\nthimble:x:" + group() + ":someone\n");
    plant("etc/passwd",
          "root:x:0:0::/root:/bin/sh\nhaptics:x:64000:64001::/:/bin/false\nmallory:x:1000:1000::/:/"
          "bin/sh\n");
    plant_process(77, "thimbled", "/dev/hidraw0");
    plant("usr/bin/thimbled", "");
    plant("usr/bin/thimble-guard", "");
    plant("usr/bin/steam", "");
    run_program(77, "usr/bin/thimbled");
    plant_status(group());
    plant("proc/self/status", "Uid:\t64000\t64000\t64000\t64000\n");  // its user asks
    plant("proc/77/cgroup", "0::/user.slice/user-1000.slice/session-3.scope\n");
    plant_limits("98", "unlimited");
    plant_node("dev/cpu_dma_latency", 0660);
  }
  void plant_node(const std::string& path, unsigned mode) const {
    plant(path, "");
    chmod(path, mode);
  }
  void plant_arm() const {
    plant(kUsb + "speed", "12\n");
    plant(kUsb + "busnum", "1\n");
    plant(kUsb + "devnum", "4\n");
    plant(kUsb + "power/control", "on\n");
    for (const auto& [file, text] :
         {std::pair{"speed", "480\n"}, {"busnum", "1\n"}, {"devnum", "1\n"}}) {
      plant(std::string("sys/devices/pci0000:00/0000:00:14.0/usb1/") + file, text);
    }
    plant_ids("00001234", "00000006");
    plant_reports(64, 64);
    plant(kHid + "hidraw/hidraw0/dev", "243:0\n");
    std::filesystem::create_symlink("../..", root_ / kHid / "hidraw/hidraw0/device");
    plant_node("dev/hidraw0", 0660);
    plant_node("dev/bus/usb/001/004", 0664);
    plant(kUsb + "1-4:1.0/usbmisc/hiddev0/dev", "180:0\n");
    plant_node("dev/usb/hiddev0", 0600);
    link_hidraw("1-4");
  }
  void link_hidraw(const std::string& port) const {
    const std::filesystem::path link = root_ / "sys/class/hidraw/hidraw0";
    std::filesystem::create_directories(link.parent_path());
    std::filesystem::remove(link);
    std::filesystem::create_symlink("../../devices/pci0000:00/0000:00:14.0/usb1/" + port +
                                        "/1-4:1.0/0003:1234:0006.0001/hidraw/hidraw0",
                                    link);
  }

  testing_support::TemporaryFolder folder_;
  const std::filesystem::path root_ = folder_.path();
};

}  // namespace thimble::doctor
