// What the enumerator of the machine says of devices that udev knows, however they lie.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <future>
#include <map>
#include <random>
#include <thread>

#include "tests/contract/linux_enumerator_fixture.hpp"
#include "tests/rt/refused_threads.hpp"

namespace thimble::test {
namespace {

TEST_F(LinuxEnumerator, DescribesAHidDeviceWithoutOpeningIt) {
  wire.attach("/dev/hidraw0");
  plug_arm("1-4", "ABC1", 0);
  const bus::BusDeviceInfo info = info_of("hid:ABC1");
  EXPECT_EQ(info.kind, bus::BusKind::Hid);
  EXPECT_EQ(info.vendor_id, 0x1234);
  EXPECT_EQ(info.product_id, 0x0006);
  EXPECT_EQ(info.manufacturer, "Maker");
  EXPECT_EQ(info.product, "Arm");
  EXPECT_EQ(info.serial_number, "ABC1");
  EXPECT_EQ(info.input_report_bytes, 14U);
  EXPECT_EQ(info.output_report_bytes, 14U);
  EXPECT_FALSE(info.has_report_ids);
  EXPECT_EQ(FakeHidWire::alive(), 0);
  EXPECT_TRUE(wire.received_by_device().empty());
}

// They go to the log, to documents and to terminals.
TEST_F(LinuxEnumerator, WordsOfADeviceBreakNoLineAndSteerNoTerminal) {
  machine.plug(Usb{.port = "1-4",
                   .serial_number = "A\nerror: B\x1b[2J",
                   .product = "Arm\r\n\x1b]0;mine\x07\xc2\x9b\x80 of \"me\""});
  machine.plug(Hid{.port = "1-4", .report_descriptor = plain_report_descriptor(14, 14)});
  machine.plug_virtual(Hid{.node_number = 1,
                           .instance = "0009",
                           .serial_number = "\x1b[2J\x7f",
                           .report_descriptor = plain_report_descriptor(14, 14)});
  for (const bus::BusDeviceInfo& info : sut->list()) {
    for (const std::string& text :
         {info.address.text, info.manufacturer, info.product, info.serial_number}) {
      EXPECT_TRUE(std::all_of(text.begin(), text.end(), [](char letter) {
        return letter >= ' ' && letter <= '~';
      })) << testing::PrintToString(text);
    }
  }
  EXPECT_EQ(info_of("hid:" + kWay + "4").serial_number, "A?error: B?[2J");
  EXPECT_EQ(info_of("hid:" + kWay + "4").product, "Arm???]0;mine???? of \"me\"");
}

TEST_F(LinuxEnumerator, DescribesAUsbDeviceAndLeavesHubsOut) {
  machine.plug(Usb{
      .port = "1-4", .vendor_id = "0403", .product_id = "cb48", .descriptors = bulk_descriptors()});
  machine.plug(Usb{.port = "1-5", .device_class = "09", .number = 5});
  EXPECT_EQ(addresses(), Texts{"usb:" + kWay + "4"});
  const bus::BusDeviceInfo info = info_of("usb:" + kWay + "4");
  EXPECT_EQ(info.kind, bus::BusKind::Usb);
  EXPECT_EQ(info.vendor_id, 0x0403);
  EXPECT_EQ(info.product_id, 0xCB48);
  EXPECT_EQ(info.endpoints,
            (std::vector<bus::UsbEndpointInfo>{{0, 0x81, bus::UsbTransferKind::Bulk, 64, 0},
                                               {0, 0x02, bus::UsbTransferKind::Bulk, 64, 0}}));
}

TEST_F(LinuxEnumerator, DescribesASerialPortOnUsbAndLeavesTheMachinesOwnOut) {
  machine.plug_console("ttyS0");
  machine.plug(
      Usb{.port = "1-4", .vendor_id = "16c0", .product_id = "0483", .serial_number = "1234567"});
  machine.plug(MockMachine::SerialDevice{.port = "1-4"});
  EXPECT_EQ(addresses(), (Texts{"serial:1234567", "usb:1234567"}));
  const bus::BusDeviceInfo info = info_of("serial:1234567");
  EXPECT_EQ(info.kind, bus::BusKind::Serial);
  EXPECT_EQ(info.vendor_id, 0x16C0);
  EXPECT_EQ(info.product_id, 0x0483);
  EXPECT_EQ(info.serial_number, "1234567");
  EXPECT_EQ(events(), (Texts{"+serial:1234567", "+usb:1234567"}));
}

// The kernel counts buses as it finds them, and a person plugs in where there is room.
TEST_F(LinuxEnumerator, ADeviceIsCalledByItsNumberWhateverItsBusAndPort) {
  const auto falcon_at = [this](const std::string& port) {
    return machine.plug(
        Usb{.port = port, .vendor_id = "0403", .product_id = "cb48", .serial_number = "F1"});
  };
  const std::string first = falcon_at("1-4");
  EXPECT_EQ(events(), Texts{"+usb:F1"});
  machine.unplug(first);
  EXPECT_EQ(events(), Texts{"-usb:F1"});
  machine.find_bus(3, "0000:00:1c.4");
  falcon_at("3-2");
  EXPECT_EQ(events(), Texts{"+usb:F1"});
  EXPECT_EQ(sut->open_usb({"usb:" + kSecondWay + "2"}, {}).error().code, Errc::NotFound)
      << "it has one name";
}

// Of what has no number that is true of its place, too.
TEST_F(LinuxEnumerator, ADeviceWithoutANumberIsCalledByItsControllerWhateverTheBusIsCounted) {
  machine.find_bus(3, MockMachine::kController);
  const std::string first = machine.plug(Usb{.port = "1-4"});
  EXPECT_EQ(addresses(), Texts{"usb:" + kWay + "4"});
  EXPECT_EQ(info_of("usb:" + kWay + "4").port, "1-4");
  machine.unplug(first);
  machine.plug(Usb{.port = "3-4"});
  EXPECT_EQ(addresses(), Texts{"usb:" + kWay + "4"});
  EXPECT_EQ(info_of("usb:" + kWay + "4").port, "3-4");
  EXPECT_EQ(sut->open_usb({"usb:3-4"}, {}).error().code, Errc::NotFound) << "it has one name";
  machine.plug(Usb{.port = "1-4"});
  EXPECT_EQ(addresses(), (Texts{"usb:1-4", "usb:3-4"})) << "no controller has two such buses";
}

TEST_F(LinuxEnumerator, DevicesOfBothRootHubsOfAControllerHaveNamesOfTheirOwn) {
  machine.find_bus(2, MockMachine::kController, " 3.00");
  machine.find_bus(3, "0000:00:1c.4");
  for (const char* port : {"1-4", "2-4", "3-4"}) machine.plug(Usb{.port = port});
  EXPECT_EQ(addresses(), (Texts{"usb:" + kWay + "4", "usb:pci-0000:00:14.0-usbv3-0:4",
                                "usb:" + kSecondWay + "4"}));
}

// Of a hundred of them each look would cost.
TEST_F(LinuxEnumerator, WhatIsNamedLikeTheMachinesOwnPortsIsNotLookedAt) {
  machine.plug(Usb{.port = "1-4"});
  machine.plug(MockMachine::SerialDevice{.port = "1-4", .name = "ttyS4"});
  EXPECT_EQ(addresses(), Texts{"usb:" + kWay + "4"});
}

TEST_F(LinuxEnumerator, APortWithoutASerialNumberOrOfAnInterfaceOfManyIsNamedByItsPlace) {
  machine.plug(Usb{.port = "1-4", .number = 4});
  machine.plug(MockMachine::SerialDevice{.port = "1-4", .name = "ttyACM0"});
  machine.plug(Usb{.port = "1-5", .serial_number = "AB", .number = 5});
  machine.plug(MockMachine::SerialDevice{.port = "1-5", .interface_number = 2, .name = "ttyUSB3"});
  EXPECT_EQ(addresses(),
            (Texts{"serial:AB:1.2", "serial:" + kWay + "4", "usb:AB", "usb:" + kWay + "4"}));
}

TEST_F(LinuxEnumerator, DevicesOfOneInterfaceHaveAddressesOfTheirOwn) {
  machine.plug(Usb{.port = "1-4"});
  const std::string first = machine.plug(MockMachine::SerialDevice{.name = "ttyUSB0"});
  machine.plug(MockMachine::SerialDevice{.name = "ttyUSB1"});
  machine.plug(Hid{});
  machine.plug(Hid{.node_number = 1, .instance = "0002"});
  EXPECT_EQ(
      addresses(),
      (Texts{"hid:" + kWay + "4:0003:1234:0006.0001", "hid:" + kWay + "4:0003:1234:0006.0002",
             "serial:" + kWay + "4:ttyUSB0", "serial:" + kWay + "4:ttyUSB1", "usb:" + kWay + "4"}));
  machine.unplug(first);
  EXPECT_EQ(info_of("serial:" + kWay + "4").kind, bus::BusKind::Serial) << "alone it needs no more";
}

TEST_F(LinuxEnumerator, ASerialPortIsOpenedAsNothingElseAndSharedOnlyWhileItIsOpen) {
  machine.plug(Usb{.serial_number = "AB"});
  const std::string path = machine.plug(MockMachine::SerialDevice{});
  EXPECT_EQ(sut->open_hid({"serial:AB"}).error().code, Errc::NotFound);
  EXPECT_EQ(sut->open_serial({"usb:AB"}, {}).error().code, Errc::NotFound);
  const auto port = sut->open_serial({"serial:AB"}, {});  // the node is a plain file here
  ASSERT_FALSE(port.has_value());
  EXPECT_NE(port.error().message.find("no terminal"), std::string::npos) << port.error().message;
  EXPECT_FALSE(sut->share({"serial:AB"}).has_value());
  machine.unplug(path);
  EXPECT_EQ(sut->open_serial({"serial:AB"}, {}).error().code, Errc::NotFound);
}

TEST_F(LinuxEnumerator, ASecondOneOfTheSameSerialNumberLeavesThemTheirPorts) {
  plug_arm("1-4", "X", 0);
  EXPECT_EQ(events(), (Texts{"+hid:X", "+usb:X"}));
  const std::string second = plug_arm("1-5", "X", 1);
  EXPECT_EQ(events(), (Texts{"-hid:X", "-usb:X", "+hid:" + kWay + "4", "+hid:" + kWay + "5",
                             "+usb:" + kWay + "4", "+usb:" + kWay + "5"}));
  EXPECT_EQ(sut->open_hid({"hid:X"}).error().code, Errc::NotFound) << "which one?";
  machine.unplug(second);
  EXPECT_EQ(events(), (Texts{"-hid:" + kWay + "4", "-hid:" + kWay + "5", "-usb:" + kWay + "4",
                             "-usb:" + kWay + "5", "+hid:X", "+usb:X"}));
}

TEST_F(LinuxEnumerator, AStrangerWithTheNumberOfAnArmLeavesTheArmItsAddress) {
  sut = std::make_unique<linux::BusEnumerator>(
      linux::BusSettings{clock, {}, {}},
      [](const bus::BusDeviceInfo& info) { return info.vendor_id == 0x1234; });
  plug_arm("1-4", "1", 0);
  EXPECT_EQ(events(), (Texts{"+hid:1", "+usb:1"}));
  machine.plug(Usb{.port = "1-3", .vendor_id = "046d", .serial_number = "1", .number = 3});
  machine.plug(Hid{.port = "1-3",
                   .node_number = 1,
                   .instance = "0002",
                   .ids = "0003:0000046D:0000C077",
                   .serial_number = "1"});
  EXPECT_EQ(events(), (Texts{"+hid:" + kWay + "3", "+usb:" + kWay + "3"}))
      << "the arm has not moved";
  EXPECT_EQ(info_of("hid:1").vendor_id, 0x1234);
  EXPECT_EQ(info_of("hid:" + kWay + "3").vendor_id, 0x046D);
}

TEST_F(LinuxEnumerator, AFurtherInterfaceAndADeviceOnNoUsbHaveAddressesOfTheirOwn) {
  plug_arm("1-4", "T1", 0);
  machine.plug(
      Hid{.interface_number = 1, .node_number = 1, .instance = "0002", .serial_number = "T1"});
  machine.plug_virtual(Hid{.node_number = 2, .instance = "0003", .serial_number = "V1"});
  EXPECT_EQ(addresses(), (Texts{"hid:T1", "hid:T1:1.1", "hid:V1", "usb:T1"}));
}

TEST_F(LinuxEnumerator, TakesWhateverADeviceSaysOfItself) {
  plug_arm("1-4", std::string(2000, 'A'), 0);
  static_cast<void>(events());
  machine.plug_virtual(Hid{
      .node_number = 1,
      .instance = "0002",
      .ids = "0003:xyz",
  });
  machine.plug_virtual(Hid{.node_number = 2, .instance = "0003", .ids = "0003:00012345:00000006"});
  machine.plug_virtual(Hid{
      .node_number = 3, .instance = "0004", .serial_number = "1-4", .report_descriptor = {0x75}});
  machine.plug(Usb{.port = "1-6", .vendor_id = "zz", .number = 6});
  machine.plug(Usb{.port = "1-7", .number = 7, .descriptors = {9, 2, 0, 0}});
  EXPECT_EQ(addresses(), (Texts{"hid:0003:1234:0006.0004", "hid:" + kWay + "4", "usb:" + kWay + "4",
                                "usb:" + kWay + "7"}));
  EXPECT_LE(info_of("hid:" + kWay + "4").serial_number.size(), 256U);
  EXPECT_EQ(info_of("hid:0003:1234:0006.0004").input_report_bytes, 0U);
  EXPECT_TRUE(info_of("usb:" + kWay + "7").endpoints.empty());
}

TEST_F(LinuxEnumerator, ANumberedDeviceShowsAsOne) {
  machine.plug_virtual(Hid{.serial_number = "P1", .report_descriptor = numbered_reports(6, 2)});
  const bus::BusDeviceInfo info = info_of("hid:P1");
  EXPECT_TRUE(info.has_report_ids);
  EXPECT_EQ(info.input_report_bytes, 7U);
  EXPECT_EQ(info.output_report_bytes, 3U);
}

TEST_F(LinuxEnumerator, AReturnBetweenTwoLooksIsADepartureAndAnArrival) {
  const std::string usb = plug_arm("1-4", "X", 0);
  sut = make();
  EXPECT_EQ(events(), Texts{}) << "it was there";
  machine.unplug(usb);
  plug_arm("1-4", "X", 1);
  const Texts seen = events();
  ASSERT_GE(seen.size(), 2U);
  EXPECT_EQ(std::count(seen.begin(), seen.end(), "-hid:X"), 1);
  EXPECT_EQ(std::count(seen.begin(), seen.end(), "+hid:X"), 1);
  EXPECT_LT(std::find(seen.begin(), seen.end(), "-hid:X"),
            std::find(seen.begin(), seen.end(), "+hid:X"));
}

TEST_F(LinuxEnumerator, AnEventThatChangesNothingIsNoArrival) {
  const std::string usb = plug_arm("1-4", "X", 0);
  static_cast<void>(events());
  for (int i = 0; i < 20; ++i) {
    machine.say(usb, "change");
    machine.say(usb, "bind");
    EXPECT_EQ(events(), Texts{});
  }
}

TEST_F(LinuxEnumerator, ADeviceThatHangsHidesNoOtherOne) {
  const std::string sick = plug_arm("1-4", "X", 0);
  EXPECT_EQ(events(), (Texts{"+hid:X", "+usb:X"}));
  machine.hang(sick, "descriptors");
  const std::string well = plug_arm("1-5", "Y", 1);
  EXPECT_EQ(events_at_last(2), (Texts{"+hid:Y", "+usb:Y"})) << "X is as it was";
  machine.unplug(well);
  EXPECT_EQ(events(), (Texts{"-hid:Y", "-usb:Y"}));
  EXPECT_EQ(addresses(), (Texts{"hid:X", "usb:X"}));
  machine.answer(sick, "descriptors");
}

TEST_F(LinuxEnumerator, ADeviceOfManyInterfacesThatHangHidesNoArmThatComesBack) {
  const std::string sick = machine.plug(Usb{.port = "1-4", .serial_number = "X"});
  machine.hang(sick, "descriptors");
  Texts interfaces;
  for (int i = 0; i < 8; ++i) {
    const std::string node = machine.plug(
        Hid{.interface_number = i, .node_number = 10 + i, .instance = "001" + std::to_string(i)});
    interfaces.push_back(node.substr(0, node.rfind("/hidraw")));
    machine.hang(interfaces.back(), "report_descriptor");
    if (i % 4 == 0) static_cast<void>(events());  // more at once than a mock machine can tell of
  }
  EXPECT_EQ(events(), Texts{});
  const std::string arm = plug_arm("1-5", "Y", 1);
  EXPECT_EQ(events_at_last(2), (Texts{"+hid:Y", "+usb:Y"}));
  machine.unplug(arm);
  EXPECT_EQ(events(), (Texts{"-hid:Y", "-usb:Y"}));
  plug_arm("1-5", "Y", 2);
  EXPECT_EQ(events_at_last(2), (Texts{"+hid:Y", "+usb:Y"}));
  for (const std::string& interface : interfaces) machine.answer(interface, "report_descriptor");
  machine.answer(sick, "descriptors");
}

// Who asks computes worlds, too.
TEST_F(LinuxEnumerator, ToAskForEventsWaitsForNoDeviceThatHangs) {
  const std::string sick = plug_arm("1-4", "X", 0);
  machine.hang(sick, "descriptors");
  for (int i = 0; i < 100; ++i) EXPECT_EQ(sut->poll_event(), std::nullopt) << "it is looked at";
  EXPECT_EQ(events_at_last(1), Texts{"+hid:X"}) << "and told of when that has ended";
  machine.answer(sick, "descriptors");
}

TEST_F(LinuxEnumerator, NewsForWhichThereIsNoThreadAreToldOfWhenThereIsOne) {
  {
    const RefusedThreads none(RefusedThreads::Which::All);
    plug_arm("1-4", "X", 0);
    EXPECT_TRUE(events().empty());
  }
  EXPECT_EQ(events(), (Texts{"+hid:X", "+usb:X"}));
}

// It is a plugin's, and other arms look, too.
TEST_F(LinuxEnumerator, ADriverThatTakesItsTimeToKnowADeviceHoldsUpNoOtherLook) {
  plug_arm("1-4", "X", 0);
  std::promise<void> is_asked;
  std::promise<void> other_look;
  std::atomic<bool> is_first{true};
  bool is_other_look_over = false;
  linux::UdevScan scan([&](const bus::BusDeviceInfo&) {
    if (!is_first.exchange(false)) return true;
    is_asked.set_value();
    is_other_look_over =
        other_look.get_future().wait_for(std::chrono::seconds(20)) == std::future_status::ready;
    return true;
  });
  std::thread first([&] { EXPECT_EQ(scan.devices().size(), 2U); });
  is_asked.get_future().wait();
  EXPECT_EQ(scan.devices().size(), 2U);
  other_look.set_value();
  first.join();
  EXPECT_TRUE(is_other_look_over);
}

TEST_F(LinuxEnumerator, ADeviceThatHangsFromTheStartIsToldOfWhenItAnswers) {
  const std::string sick = plug_arm("1-4", "X", 0);
  machine.hang(sick, "descriptors");
  EXPECT_EQ(events_at_last(1), Texts{"+hid:X"});
  plug_arm("1-5", "Y", 1);
  EXPECT_EQ(events_at_last(2), (Texts{"+hid:Y", "+usb:Y"}));
  machine.answer(sick, "descriptors");
  EXPECT_EQ(events_at_last(1), Texts{"+usb:X"}) << "of its own accord: udevd says nothing";
}

TEST_F(LinuxEnumerator, WhatIsToldAddsUpToWhatIsListed) {
  std::mt19937 random(7);
  std::map<std::string, std::string> plugged;  // path by port
  std::map<std::string, int> told;
  for (int step = 0; step < 60; ++step) {
    const std::string port = "1-" + std::to_string(1 + random() % 4);
    if (plugged.contains(port)) {
      machine.unplug(plugged[port]);
      plugged.erase(port);
    } else {
      plugged[port] = plug_arm(port, random() % 2 == 0 ? "X" : "", step);
    }
    if (step % 2 != 0 && random() % 2 == 0) continue;
    sut->catch_up(std::chrono::seconds(20));
    while (const auto event = sut->poll_event()) {
      int& count = told[event->device.address.text];
      count += event->kind == bus::BusEvent::Kind::Arrived ? 1 : -1;
      ASSERT_TRUE(count == 0 || count == 1) << event->device.address.text;
    }
    Texts there;
    for (const auto& [address, count] : told) {
      if (count == 1) there.push_back(address);
    }
    ASSERT_EQ(there, addresses()) << step;
  }
}

// The kernel gives the name of a node that is free to whatever comes next.
}  // namespace
}  // namespace thimble::test
