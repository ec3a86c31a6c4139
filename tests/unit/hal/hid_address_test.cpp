#include "hal/linux/hid_address.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

namespace thimble::linux {
namespace {

using Texts = std::vector<std::string>;

Texts addresses_of(const std::vector<DevicePlace>& places) {
  Texts texts;
  for (const bus::DeviceAddress& address : hid_addresses(places)) texts.push_back(address.text);
  return texts;
}

TEST(HidAddress, IsTheSerialNumberWhereItIsUnique) {
  EXPECT_EQ(addresses_of({{"1-4", 0, "A1"}, {"1-5", 0, "B2"}}), (Texts{"hid:A1", "hid:B2"}));
}

TEST(HidAddress, IsThePortWithoutOneOrWhereTwoSayTheSame) {
  EXPECT_EQ(addresses_of({{"1-4", 0, ""}, {"1-5.2", 0, "X"}, {"2-1", 0, "X"}}),
            (Texts{"hid:1-4", "hid:1-5.2", "hid:2-1"}));
}

TEST(HidAddress, OfAnArmStaysItsSerialNumberWhateverElseHasIt) {
  EXPECT_EQ(addresses_of({{"1-4", 0, "1", true}, {"1-5", 0, "1"}, {"1-6", 0, "1"}}),
            (Texts{"hid:1", "hid:1-5", "hid:1-6"}));
  EXPECT_EQ(addresses_of({{"1-3", 0, "1"}, {"1-4", 0, "1", true}, {"1-4", 1, "1"}}),
            (Texts{"hid:1-3", "hid:1", "hid:1:1.1"}))
      << "in whatever order, and of all that is at its port";
  EXPECT_EQ(addresses_of({{"1-4", 0, "1", true}, {"1-5", 0, "1", true}, {"1-6", 0, "1"}}),
            (Texts{"hid:1-4", "hid:1-5", "hid:1-6"}))
      << "which of two arms is meant cannot be guessed";
}

// Buses are counted as the kernel finds them; the way from the controller stays.
TEST(HidAddress, IsThePathWhereThereIsOneAndNoNumber) {
  const DevicePlace plain{"1-4", 0, "", false, "pci-0000:00:14.0-usb-0:4"};
  DevicePlace counted_anew = plain;
  counted_anew.port = "3-4";
  EXPECT_EQ(addresses_of({plain}), Texts{"hid:pci-0000:00:14.0-usb-0:4"});
  EXPECT_EQ(addresses_of({counted_anew}), addresses_of({plain}));
  EXPECT_EQ(addresses_of({plain, {"1-4", 2, "", false, plain.path}, {"1-5", 0, "A1", false, "x"}}),
            (Texts{"hid:pci-0000:00:14.0-usb-0:4", "hid:pci-0000:00:14.0-usb-0:4:1.2", "hid:A1"}));
  EXPECT_EQ(addresses_of({{"1-4", 0, "X", false, "a"}, {"2-4", 0, "X", false, "b"}}),
            (Texts{"hid:a", "hid:b"}));
}

TEST(HidAddress, IsThePortWhereTwoHaveOnePath) {
  EXPECT_EQ(
      addresses_of(
          {{"1-4", 0, "", false, "a"}, {"2-4", 1, "", false, "a"}, {"2-5", 0, "", false, "b"}}),
      (Texts{"hid:1-4", "hid:2-4:1.1", "hid:b"}));
  EXPECT_EQ(addresses_of({{"1-4", 0, "A1", false, "a"}, {"2-4", 0, "", false, "a"}}),
            (Texts{"hid:A1", "hid:2-4"}))
      << "also where one of them has a number today";
  EXPECT_EQ(addresses_of({{"1-4", 0, "", true, "a"}, {"2-4", 0, "", false, "a"}}),
            (Texts{"hid:a", "hid:2-4"}))
      << "an arm's stays its own, as its number does";
}

TEST(HidAddress, TellsDevicesOfOneInterfaceApart) {
  const DevicePlace first{"1-4", 0, "A1", false, "a", "ttyUSB0"};
  DevicePlace second = first;
  second.own_name = "ttyUSB1";
  DevicePlace third = first;
  third.interface_number = 1;
  EXPECT_EQ(addresses_of({first, third}), (Texts{"hid:A1", "hid:A1:1.1"}));
  EXPECT_EQ(addresses_of({first, second, third}),
            (Texts{"hid:A1:ttyUSB0", "hid:A1:ttyUSB1", "hid:A1:1.1"}));
}

TEST(HidAddress, SaysBesideWhatThePortIsCalledToday) {
  EXPECT_EQ(port_name({"1-4.2", 0, "A1", false, "a"}), "1-4.2");
  EXPECT_EQ(port_name({"1-4.2", 3, "A1", false, "a"}), "1-4.2:1.3");
}

TEST(HidAddress, NamesFurtherInterfacesOfADevice) {
  EXPECT_EQ(addresses_of({{"1-4", 0, "A1"}, {"1-4", 1, "A1"}, {"1-5", 2, ""}}),
            (Texts{"hid:A1", "hid:A1:1.1", "hid:1-5:1.2"}));
}

TEST(HidAddress, OfAUsbDeviceIsMadeInTheSameWay) {
  const std::vector<DevicePlace> places{{"1-4", 0, "F1", true}, {"1-5", 0, "F1"}, {"2-1", 0, ""}};
  const std::vector<bus::DeviceAddress> addresses = usb_addresses(places);
  ASSERT_EQ(addresses.size(), 3U);
  EXPECT_EQ(addresses[0].text, "usb:F1");
  EXPECT_EQ(addresses[1].text, "usb:1-5");
  EXPECT_EQ(addresses[2].text, "usb:2-1");
}

TEST(HidAddress, OfASerialPortIsMadeInTheSameWay) {
  const std::vector<DevicePlace> places{{"1-4", 0, "A1"}, {"1-5", 0, ""}, {"1-6", 2, "B"}};
  const std::vector<bus::DeviceAddress> addresses = serial_addresses(places);
  ASSERT_EQ(addresses.size(), 3U);
  EXPECT_EQ(addresses[0].text, "serial:A1");
  EXPECT_EQ(addresses[1].text, "serial:1-5");
  EXPECT_EQ(addresses[2].text, "serial:B:1.2");
}

TEST(HidAddress, TakesNoSerialNumberThatReadsLikeSomethingElse) {
  for (const std::string& odd :
       {std::string("1-4"), std::string("10-4.2.1"), std::string("4-"), std::string("A1:1.1"),
        std::string("A 1"), std::string("A\n1"), std::string("\xc3\xa4"), std::string("A\"1"),
        std::string(65, 'A'), std::string("A\0", 2), std::string("")}) {
    EXPECT_FALSE(is_usable_serial(odd)) << odd;
    EXPECT_EQ(addresses_of({{"1-9", 0, odd}}), Texts{"hid:1-9"}) << odd;
  }
  for (const char* good : {"A1", "0", "-4", "1-A", "a_b.c+d-e"}) {
    EXPECT_TRUE(is_usable_serial(good)) << good;
  }
}

// Whatever devices say, no two addresses are the same, and none is another's port.
TEST(HidAddress, LeadsToOneDeviceOnly) {
  std::mt19937 random(4);
  const Texts serials{"",
                      "A1",
                      "1-1",
                      "1-2.1",
                      "A1:1.1",
                      "1-1:1.1",
                      "x",
                      "0003:1234:0006.0001",
                      "platform-soc-usb-0",
                      "platform-soc-usbv3-0"};
  const Texts paths{"",
                    "pci-0000:00:14.0-usb-0:1",
                    "pci-0000:00:14.0-usb-0:1.1",
                    "pci-0000:00:14.0-usbv3-0:1",
                    "platform-soc-usb-0:1.1",
                    "platform-soc-usb-0:1",
                    "platform-soc-usbv3-0:1.1"};
  for (int round = 0; round < 5000; ++round) {
    std::vector<DevicePlace> places;
    for (const char* port : {"1-1", "1-2", "1-2.1", "0003:1234:0006.0001"}) {
      const std::string serial = serials[random() % serials.size()];
      const std::string path = paths[random() % paths.size()];
      const std::size_t interfaces = random() % 3;
      for (unsigned i = 0; i < interfaces; ++i) {
        const bool is_arm = random() % 2 == 0;
        const std::size_t devices = 1 + random() % 8 / 7;
        for (std::size_t one = 0; one < devices; ++one) {
          places.push_back({port, i, serial, is_arm, path, "tty" + std::to_string(places.size())});
        }
      }
    }
    const Texts addresses = addresses_of(places);
    // What no driver knows comes and goes: no arm is called otherwise for it.
    std::vector<DevicePlace> arms;
    Texts of_arms;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const bool is_of_arm = std::any_of(
          places.begin(), places.end(),
          [&](const DevicePlace& place) { return place.port == places[i].port && place.is_arm; });
      if (!is_of_arm) continue;
      arms.push_back(places[i]);
      of_arms.push_back(addresses[i]);
    }
    EXPECT_EQ(addresses_of(arms), of_arms);
    EXPECT_EQ(std::set<std::string>(addresses.begin(), addresses.end()).size(), addresses.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
      for (const DevicePlace& other : places) {
        if (other.port == places[i].port) continue;
        EXPECT_FALSE(addresses[i].starts_with("hid:" + other.port + ":")) << addresses[i];
        EXPECT_NE(addresses[i], "hid:" + other.port);
      }
    }
  }
}

}  // namespace
}  // namespace thimble::linux
