#pragma once

#include <gtest/gtest.h>
#include <poll.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "hal/linux/bus_enumerator.hpp"
#include "hal/linux/monotonic_clock.hpp"
#include "tests/support/fake_hidapi.hpp"
#include "tests/support/look_again.hpp"
#include "tests/support/mock_machine.hpp"

namespace thimble::test {

// The enumerator of a machine that is made up (umockdev), and what stands on it.
struct LinuxEnumerator : testing::Test {
  using Texts = std::vector<std::string>;
  using Usb = MockMachine::UsbDevice;
  using Hid = MockMachine::HidDevice;

  // To the ports of MockMachine's controller, and to those of a second one.
  static inline const std::string kWay = "pci-0000:00:14.0-usb-0:";
  static inline const std::string kSecondWay = "pci-0000:00:1c.4-usb-0:";

  linux::MonotonicClock clock;
  MockMachine machine;
  FakeHidWire wire;  // it outlives what a stalled machine closes at the end of `sut` only
  std::unique_ptr<linux::BusEnumerator> sut = make();

  std::unique_ptr<linux::BusEnumerator> make() {
    return std::make_unique<linux::BusEnumerator>(linux::BusSettings{clock, {}, {}});
  }
  ~LinuxEnumerator() override {
    sut.reset();
    EXPECT_EQ(FakeHidWire::alive(), 0);
  }

  Texts addresses() {
    Texts texts;
    for (const bus::BusDeviceInfo& info : sut->list()) texts.push_back(info.address.text);
    std::sort(texts.begin(), texts.end());
    return texts;
  }
  // "+" arrived, "-" left.
  Texts events() {
    Texts texts;
    sut->catch_up(std::chrono::seconds(20));
    while (const auto event = sut->poll_event()) {
      const bool is_arrival = event->kind == bus::BusEvent::Kind::Arrived;
      texts.push_back((is_arrival ? "+" : "-") + event->device.address.text);
    }
    return texts;
  }
  // As many, in order of their text: a stalled machine has not read all at its first look.
  Texts events_at_last(std::size_t count) {
    constexpr int kLooks = 20'000;
    Texts texts = events();
    for (int looks = 1; looks < kLooks && texts.size() < count; ++looks) {
      ::poll(nullptr, 0, 1);
      const Texts more = events();
      texts.insert(texts.end(), more.begin(), more.end());
    }
    std::sort(texts.begin(), texts.end());
    return texts;
  }
  bus::BusDeviceInfo info_of(const std::string& address) {
    for (const bus::BusDeviceInfo& info : sut->list()) {
      if (info.address.text == address) return info;
    }
    ADD_FAILURE() << address << " is not listed";
    return {};
  }
  // Of one that is there and that nobody has.
  Result<std::unique_ptr<bus::HidDevice>> open_at_last(const bus::DeviceAddress& address) {
    return look_again({Errc::Busy, Errc::NotFound}, [&] { return sut->open_hid(address); });
  }
  std::string plug_arm(const std::string& port, const std::string& serial, int number) {
    const std::string usb = machine.plug(Usb{.port = port, .serial_number = serial});
    machine.plug(Hid{.port = port,
                     .node_number = number,
                     .instance = "0" + std::to_string(100 + number),
                     .serial_number = serial,
                     .report_descriptor = plain_report_descriptor(14, 14)});
    return usb;
  }
};

}  // namespace thimble::test
