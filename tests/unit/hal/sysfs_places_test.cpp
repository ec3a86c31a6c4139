#include "hal/linux/sysfs_places.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <random>

#include "tests/support/temporary_folder.hpp"

namespace thimble::linux {
namespace {

namespace fs = std::filesystem;

// A folder like sysfs. What a kernel shows behind the lock of a device is a pipe there, at which a
// reader waits for ever.
class SysfsPlaces : public testing::Test {
 protected:
  ~SysfsPlaces() override {
    for (const int pipe : pipes_) ::close(pipe);
  }
  void SetUp() override {
    usb("usb1", "09", "1");
    usb("usb1/1-4", "00", "7");
    below("usb1/1-4", "1-4:1.0", "bus/usb/devices");
  }
  static void write(const fs::path& file, const std::string& text) {
    std::ofstream(file) << text << '\n';
  }
  void hang(const fs::path& file) {
    ASSERT_EQ(::mkfifo(file.c_str(), 0600), 0);
    pipes_.push_back(::open(file.c_str(), O_RDWR | O_CLOEXEC));
  }
  // With the link that its class or bus has.
  fs::path below(const std::string& parent, const std::string& name, const std::string& list) {
    const fs::path path = sys_ / "devices" / parent / name;
    fs::create_directories(path);
    hang(path / "uevent");
    fs::create_directories(sys_ / list);
    fs::create_symlink(path, sys_ / list / path.filename());
    return path;
  }
  fs::path usb(const std::string& name, const std::string& device_class,
               const std::string& number) {
    const fs::path path = below("", name, "bus/usb/devices");
    write(path / "bDeviceClass", device_class);
    write(path / "devnum", number);
    for (const char* behind : {"serial", "product", "manufacturer", "bConfigurationValue"}) {
      hang(path / behind);
    }
    return path;
  }
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> out;
    for (const SysfsPlace& place : sysfs_places(sys_)) {
      out.push_back(fs::path(place.path).filename());
    }
    return out;
  }
  using Texts = std::vector<std::string>;

  testing_support::TemporaryFolder folder_;
  fs::path sys_ = fs::canonical(folder_ / "");
  std::vector<int> pipes_;
};

TEST_F(SysfsPlaces, AreListedWithoutAWordFromDevicesThatAreHeldUp) {
  below("usb1/1-4/1-4:1.0/0003:1234:0006.0001", "hidraw0", "class/hidraw");
  below("usb1/1-4/1-4:1.1/tty", "ttyACM0", "class/tty");
  EXPECT_EQ(names(), (Texts{"hidraw0", "ttyACM0", "1-4"}));
  const auto places = sysfs_places(sys_);
  EXPECT_EQ(places[2].path, sys_ / "devices/usb1/1-4");
  EXPECT_EQ(places[1].path, sys_ / "devices/usb1/1-4/1-4:1.1/tty/ttyACM0");
}

TEST_F(SysfsPlaces, AreOfTheUsbDeviceNextAboveThemOrOfTheirOwn) {
  usb("usb1/1-5", "09", "8");
  usb("usb1/1-5/1-5.2", "00", "9");
  below("usb1/1-4/1-4:1.0/0003:1234:0006.0001/hidraw", "hidraw0", "class/hidraw");
  below("usb1/1-5/1-5.2/1-5.2:1.1/tty", "ttyACM0", "class/tty");
  const auto uhid = below("virtual/misc/uhid/0005:1234:0006.0002", "hidraw1", "class/hidraw");
  std::map<std::string, std::string> devices;
  for (const SysfsPlace& place : sysfs_places(sys_)) {
    devices[fs::path(place.path).filename()] = place.device;
  }
  const std::map<std::string, std::string> expected{{"hidraw0", sys_ / "devices/usb1/1-4"},
                                                    {"1-4", sys_ / "devices/usb1/1-4"},
                                                    {"ttyACM0", sys_ / "devices/usb1/1-5/1-5.2"},
                                                    {"1-5.2", sys_ / "devices/usb1/1-5/1-5.2"},
                                                    {"hidraw1", uhid}};
  EXPECT_EQ(devices, expected);
}

TEST_F(SysfsPlaces, LeaveOutHubsInterfacesAndThePortsThatAreOnNoUsb) {
  usb("usb1/1-5", "09", "8");
  for (const char* name : {"tty0", "ttyS0", "ttyprintk"}) below("virtual/tty", name, "class/tty");
  below("usb1/1-4/1-4:1.1/tty", "ttyS9", "class/tty");
  EXPECT_EQ(names(), Texts{"1-4"});
}

TEST_F(SysfsPlaces, AreOtherOnesAfterThatDeviceWasPluggedInAnew) {
  const fs::path port = below("usb1/1-4/1-4:1.1/tty", "ttyACM0", "class/tty");
  const auto before = sysfs_places(sys_);
  write(sys_ / "devices/usb1/1-4/devnum", "9");
  const auto after = sysfs_places(sys_);
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < after.size(); ++i) {
    EXPECT_EQ(after[i].path, before[i].path);
    EXPECT_NE(after[i].identity, before[i].identity) << after[i].path;
  }
}

TEST_F(SysfsPlaces, AreNoneWhereThereIsNoSysfsAndWhereLinksLeadNowhere) {
  EXPECT_TRUE(sysfs_places(sys_ / "nowhere").empty());
  fs::create_directories(sys_ / "class/hidraw");
  fs::create_symlink(sys_ / "gone", sys_ / "class/hidraw/hidraw3");
  EXPECT_EQ(names(), Texts{"1-4"});
}

// Attributes that say anything at all, as a kernel's never do.
TEST_F(SysfsPlaces, AreTotal) {
  std::mt19937 random(3);
  for (int i = 0; i < 300; ++i) {
    std::string text;
    for (std::size_t n = random() % 60; n > 0; --n) text += static_cast<char>(random());
    write(sys_ / "devices/usb1/1-4" / (random() % 2 == 0 ? "devnum" : "bDeviceClass"), text);
    EXPECT_LE(names().size(), 1U);
  }
}

}  // namespace
}  // namespace thimble::linux
