// How devices of the machine are opened, and shared with a guard, however they come and go
// meanwhile.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <utility>

#include "hal/linux/udev_scan.hpp"
#include "tests/contract/linux_enumerator_fixture.hpp"
#include "tests/rt/in_child_process.hpp"
#include "tests/rt/wait_until.hpp"

namespace thimble::test {
namespace {

namespace fs = std::filesystem;

TEST_F(LinuxEnumerator, ANodeThatBecameAnotherDevicesWhileItWasOpenedIsRefused) {
  wire.attach("/dev/hidraw0");
  const std::string arm = plug_arm("1-4", "X", 0);
  wire.at_next_opening([&] {
    machine.unplug(arm);
    machine.plug(Usb{.port = "1-5", .number = 5});
    machine.plug(Hid{.port = "1-5",
                     .instance = "0200",
                     .serial_number = "Y",
                     .report_descriptor = plain_report_descriptor(14, 14)});
  });
  const auto opened = look_again({Errc::Busy}, [&] { return sut->open_hid({"hid:X"}); });
  ASSERT_FALSE(opened.has_value());
  EXPECT_EQ(opened.error().code, Errc::NotFound);
  EXPECT_NE(opened.error().message.find("hid:X"), std::string::npos) << opened.error().message;
  EXPECT_TRUE(wire.received_by_device().empty()) << "nothing was sent to the other one";
  EXPECT_TRUE(open_at_last({"hid:Y"}).has_value()) << "and it is not held";
}

TEST_F(LinuxEnumerator, SharesTheNodeOfAnOpenHidDeviceWithWhoMayHaveToLetItGo) {
  wire.attach("/dev/hidraw0");
  plug_arm("1-4", "X", 0);
  EXPECT_EQ(sut->share({"hid:X"}).error().code, Errc::NotFound) << "it is not open";
  auto device = open_at_last({"hid:X"});
  ASSERT_TRUE(device.has_value()) << device.error().message;
  const auto shared = sut->share({"hid:X"});
  ASSERT_TRUE(shared.has_value()) << shared.error().message;
  EXPECT_EQ(shared->way, linux::NodeWay::HidrawAfterZero);
  EXPECT_EQ(::write(shared->node.get(), "zero", 4), 4);
  std::string written(4, ' ');
  const int node = ::open("/dev/hidraw0", O_RDONLY | O_CLOEXEC);
  EXPECT_EQ(::read(node, written.data(), written.size()), 4);
  EXPECT_EQ(written, "zero");
  EXPECT_EQ(::close(node), 0);
  device->reset();
  // What a stalled machine closes late is shared until then.
  ASSERT_TRUE(wait_until([&] { return !sut->share({"hid:X"}).has_value(); })) << "closed again";
  EXPECT_EQ(sut->share({"hid:X"}).error().code, Errc::NotFound);
  EXPECT_EQ(::write(shared->node.get(), "zero", 4), 4) << "what was shared lasts";
}

// While one takes no report, the kernel opens no HID device (hidraw's lock), and who looks after
// the arms must not wait for it.
TEST_F(LinuxEnumerator, ToShareNeitherLooksNorOpens) {
  wire.attach("/dev/hidraw0");
  const std::string arm = plug_arm("1-4", "X", 0);
  const auto device = open_at_last({"hid:X"});
  ASSERT_TRUE(device.has_value()) << device.error().message;
  machine.unplug(arm);
  EXPECT_TRUE(sut->share({"hid:X"}).has_value());
}

TEST_F(LinuxEnumerator, AReportWithANumberIsSharedWithoutAZeroBeforeIt) {
  wire.attach("/dev/hidraw0");
  machine.plug_virtual(Hid{.serial_number = "P1", .report_descriptor = numbered_reports(6, 2)});
  const auto device = open_at_last({"hid:P1"});
  ASSERT_TRUE(device.has_value()) << device.error().message;
  const auto shared = sut->share({"hid:P1"});
  ASSERT_TRUE(shared.has_value()) << shared.error().message;
  EXPECT_EQ(shared->way, linux::NodeWay::AsTheyAre);
}

TEST_F(LinuxEnumerator, TheHiddevOfAHidDeviceIsThatOfItsInterface) {
  plug_arm("1-4", "X", 0);
  machine.plug_hiddev("1-4", 0, "hiddev4");
  machine.plug(Hid{.interface_number = 1, .node_number = 3, .instance = "0103"});
  machine.plug_hiddev("1-4", 1, "hiddev3");
  static_cast<void>(events());  // more at once than a mock machine can tell of
  plug_arm("1-5", "Y", 1);
  machine.plug_virtual({.node_number = 2, .instance = "0102", .serial_number = "Z"});
  linux::UdevScan scan;
  std::map<std::string, std::string> hiddevs;
  for (const linux::FoundDevice& device : scan.devices()) {
    if (device.info.kind == bus::BusKind::Hid) hiddevs[device.info.address.text] = device.hiddev;
  }
  EXPECT_EQ(hiddevs, (std::map<std::string, std::string>{{"hid:X", "/dev/usb/hiddev4"},
                                                         {"hid:X:1.1", "/dev/usb/hiddev3"},
                                                         {"hid:Y", ""},
                                                         {"hid:Z", ""}}));
}

bool is_open_here(const std::string& name) {
  const std::filesystem::directory_iterator open("/proc/self/fd");
  return std::any_of(begin(open), end(open), [&](const auto& entry) {
    std::error_code error;
    return std::filesystem::read_symlink(entry.path(), error).filename() == name;
  });
}

// The first opening of a device lasts, and within hidraw it would hold up every other arm.
TEST_F(LinuxEnumerator, TheHiddevOfAnArmIsOpenBeforeItsHidrawNodeAndUntilItIsClosed) {
  wire.attach("/dev/hidraw0");
  plug_arm("1-4", "X", 0);
  machine.plug_hiddev("1-4", 0, "hiddev7");
  bool is_first = false;
  wire.at_next_opening([&] { is_first = is_open_here("hiddev7"); });
  auto opened = open_at_last({"hid:X"});
  ASSERT_TRUE(opened.has_value()) << opened.error().message;
  EXPECT_TRUE(is_first);
  EXPECT_TRUE(is_open_here("hiddev7"));
  opened->reset();
  sut.reset();
  EXPECT_FALSE(is_open_here("hiddev7"));
}

TEST_F(LinuxEnumerator, WithoutAHiddevThatAnswersHidrawIsTheWay) {
  wire.attach("/dev/hidraw0");
  plug_arm("1-4", "X", 0);
  machine.plug_hiddev("1-4", 0, "hiddev0");  // a plain file: no report, says the kernel
  auto device = open_at_last({"hid:X"});
  ASSERT_TRUE(device.has_value()) << device.error().message;
  const auto shared = sut->share({"hid:X"});
  ASSERT_TRUE(shared.has_value()) << shared.error().message;
  EXPECT_EQ(shared->way, linux::NodeWay::HidrawAfterZero);
  const std::vector<std::uint8_t> zero(14, 0);
  EXPECT_EQ((*device)->submit(zero), IoStatus::Ok);
  device->reset();
  sut.reset();  // waits for what a stalled machine has not written yet
  EXPECT_EQ(wire.received_by_device(), (std::vector<FakeHidWire::Report>{zero}));
}

// Does something each time somebody asks for the time, and goes on only then: a machine that stalls
// uses up nobody's patience.
class WatchedClock final : public Clock {
 public:
  explicit WatchedClock(std::function<void()> happening) : happening_(std::move(happening)) {}
  [[nodiscard]] MonotonicTime now() const noexcept override {
    happening_();
    return {kStep * ++looks_};
  }
  Duration sleep_until(MonotonicTime) noexcept override { return {}; }

 private:
  static constexpr Duration kStep = std::chrono::milliseconds(5);
  std::function<void()> happening_;
  mutable std::atomic<int> looks_{0};
};

// A device on hidraw whose hiddev is there and nobody's, for who has no rights but to hidraw.
struct ClosedHiddev : LinuxEnumerator {
  // Of a device with these reports.
  void plug(const MockMachine::Bytes& reports) {
    wire.attach("/dev/hidraw0");
    machine.plug(Usb{.serial_number = "X"});
    machine.plug(Hid{.serial_number = "X", .report_descriptor = reports});
    machine.plug_hiddev("1-4", 0, "hiddev7");
    machine.let_others_look();
    fs::permissions(machine.file_of("/dev/hidraw0"), fs::perms(0666));
    fs::permissions(hiddev, fs::perms::none);
    fs::permissions(fs::path(hiddev).parent_path(), fs::perms(0755));
    EXPECT_EQ(::chown(hiddev.c_str(), kNobody, kNobody), 0);
  }
  // How it goes, where each look at the clock makes something happen.
  std::string open(const std::function<void()>& happening) {
    return in_child_process(Rights::None, [&] {
      const WatchedClock watched(happening);
      linux::BusEnumerator buses(linux::BusSettings{watched, {}, {}});
      const auto opened = look_again(
          {Errc::Busy, Errc::NotFound}, [&] { return buses.open_hid({"hid:X"}); }, 10);
      if (opened.has_value()) return std::string("opened");
      return std::string(to_string(opened.error().code)) + " " + opened.error().message;
    });
  }

  static constexpr ::uid_t kNobody = 65534;
  const std::string hiddev = machine.file_of("/dev/usb/hiddev7");
};

TEST_F(ClosedHiddev, IsARefusalThatNamesIt) {
  plug(plain_report_descriptor(14, 14));
  const std::string said = open([] {});
  EXPECT_EQ(said.find(std::string(to_string(Errc::Permission)) + " hid:X: /dev/usb/hiddev7"), 0U)
      << said;
}

// udevd comes to one node after the other.
TEST_F(ClosedHiddev, ItsRightsMayComeAMomentLater) {
  plug(plain_report_descriptor(14, 14));
  const std::string said = open([this, looks = std::make_shared<std::atomic<int>>(0)] {
    if (++*looks == 20) fs::permissions(hiddev, fs::perms(0400));
  });
  EXPECT_EQ(said, "opened");
}

TEST_F(ClosedHiddev, IsNoneOfAPucksAffairs) {
  plug(numbered_reports(13, 2));
  EXPECT_EQ(open([] {}), "opened");
}

TEST_F(ClosedHiddev, NorOfADeviceToWhichNothingIsSent) {
  plug(plain_report_descriptor(14, 0));
  EXPECT_EQ(open([] {}), "opened");
}

TEST_F(LinuxEnumerator, SharesNoUsbDeviceThatItDidNotOpen) {
  plug_arm("1-4", "X", 0);
  EXPECT_EQ(sut->share({"usb:X"}).error().code, Errc::NotFound);
  EXPECT_EQ(sut->share({"hid:Y"}).error().code, Errc::NotFound);
}

TEST_F(LinuxEnumerator, RefusalsAreToldApart) {
  plug_arm("1-4", "X", 0);
  EXPECT_EQ(sut->open_hid({"hid:Y"}).error().code, Errc::NotFound);
  EXPECT_EQ(sut->open_hid({"usb:X"}).error().code, Errc::NotFound) << "of the other kind";
  EXPECT_EQ(sut->open_usb({"hid:X"}, {}).error().code, Errc::NotFound);
  const auto no_usb = sut->open_usb({"usb:X"}, {});
  ASSERT_FALSE(no_usb.has_value());
  EXPECT_NE(no_usb.error().message.find("usb:X"), std::string::npos);
  machine.let_others_look();
  const std::string said = in_child_process(Rights::None, [&] {
    const auto hid = look_again({Errc::Busy}, [&] { return sut->open_hid({"hid:X"}); });
    const auto usb = sut->open_usb({"usb:X"}, {});
    if (hid.has_value() || usb.has_value()) return std::string("opened");
    return std::string(to_string(hid.error().code)) + " " +
           std::string(to_string(usb.error().code)) + " " + hid.error().message;
  });
  const std::string permission(to_string(Errc::Permission));
  EXPECT_EQ(said.find(permission + " " + permission), 0U) << said;
  EXPECT_NE(said.find("hid:X: /dev/hidraw0"), std::string::npos) << said;
}

}  // namespace
}  // namespace thimble::test
