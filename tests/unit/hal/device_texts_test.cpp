#include "hal/linux/device_texts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace thimble::linux {
namespace {

DeviceTexts arm() {
  DeviceTexts texts;
  texts.node = "/dev/hidraw0";
  texts.hiddev = "/dev/usb/hiddev0";
  texts.port = "1-4";
  texts.path = "pci-0000:00:14.0-usb-0:4";
  texts.hid_id = "0003:00001234:0000ABCD";
  texts.hid_name = "Maker Arm of HID";
  texts.vendor_id = "16c0";
  texts.product_id = "0483";
  texts.manufacturer = "Maker";
  texts.product = "Arm";
  texts.serial_number = "ABC1";
  texts.interface_number = "02";
  return texts;
}

using Reader = std::optional<ReadDevice> (*)(const DeviceTexts&);

TEST(DeviceTexts, OfAHidDeviceAreItsOwnIdsAndTheWordsOfItsUsbDevice) {
  const auto read = hid_device_of(arm());
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->device.node, "/dev/hidraw0");
  EXPECT_EQ(read->device.hiddev, "/dev/usb/hiddev0");
  const bus::BusDeviceInfo& info = read->device.info;
  EXPECT_EQ(info.kind, bus::BusKind::Hid);
  EXPECT_EQ(info.vendor_id, 0x1234);
  EXPECT_EQ(info.product_id, 0xABCD);
  EXPECT_EQ(info.manufacturer, "Maker");
  EXPECT_EQ(info.product, "Arm");
  ASSERT_TRUE(read->place.has_value());
  EXPECT_EQ(read->place->port, "1-4");
  EXPECT_EQ(read->place->path, "pci-0000:00:14.0-usb-0:4");
  EXPECT_EQ(read->place->interface_number, 2U);
  EXPECT_EQ(read->place->serial_number, "ABC1");
}

TEST(DeviceTexts, OfAHidDeviceOnNoUsbAreItsOwn) {
  DeviceTexts texts = arm();
  texts.is_on_usb = false;
  texts.hid_uniq = "V1";
  const auto read = hid_device_of(texts);
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->device.info.product, "Maker Arm of HID");
  EXPECT_EQ(read->device.info.manufacturer, "");
  EXPECT_EQ(read->device.info.serial_number, "V1");
  EXPECT_EQ(read->place->interface_number, 0U);
  EXPECT_EQ(read->place->path, "") << "of no USB";
}

TEST(DeviceTexts, OfAUsbDeviceAndASerialPortAreTheUsbDevices) {
  const auto usb = usb_device_of(arm());
  const auto serial = serial_port_of(arm());
  ASSERT_TRUE(usb.has_value() && serial.has_value());
  EXPECT_EQ(usb->place->port, "1-4");
  EXPECT_EQ(usb->place->interface_number, 0U) << "it is all its interfaces";
  EXPECT_EQ(serial->place->interface_number, 2U);
  for (const auto* read : {&*usb, &*serial}) {
    EXPECT_EQ(read->device.info.vendor_id, 0x16C0);
    EXPECT_EQ(read->device.info.product_id, 0x0483);
    EXPECT_EQ(read->device.info.serial_number, "ABC1");
  }
}

TEST(DeviceTexts, WithoutNodeVendorOrProductAreNoDevice) {
  for (const Reader read : {&hid_device_of, &serial_port_of, &usb_device_of}) {
    DeviceTexts texts = arm();
    texts.node.clear();
    EXPECT_FALSE(read(texts).has_value());
  }
  for (const char* number : {"", "zz", "-1", "+1", " 1", "1 ", "0x1", "10000", "fffffffff"}) {
    for (const Reader read : {&serial_port_of, &usb_device_of}) {
      DeviceTexts texts = arm();
      texts.vendor_id = number;
      EXPECT_FALSE(read(texts).has_value()) << number;
      texts = arm();
      texts.product_id = number;
      EXPECT_FALSE(read(texts).has_value()) << number;
    }
    for (const std::string& ids : {std::string(number), "0003:" + std::string(number) + ":1",
                                   "0003:1:" + std::string(number), "0003" + std::string(number)}) {
      DeviceTexts texts = arm();
      texts.hid_id = ids;
      EXPECT_FALSE(hid_device_of(texts).has_value()) << ids;
    }
  }
}

TEST(DeviceTexts, WordsAreCutAndPrintable) {
  DeviceTexts texts = arm();
  texts.manufacturer = std::string(2000, 'M');
  texts.product = "Arm\r\n\x1b]0;mine\x07\xc2\x9b";
  texts.serial_number = "";
  texts.hid_uniq = std::string(300, '\x80');
  const bus::BusDeviceInfo info = hid_device_of(texts)->device.info;
  EXPECT_EQ(info.manufacturer, std::string(kMaxTextBytes, 'M'));
  EXPECT_EQ(info.product, "Arm???]0;mine???");
  EXPECT_EQ(info.serial_number, std::string(kMaxTextBytes, '?'));
}

TEST(DeviceTexts, ANumberOfAnInterfaceThatIsNoneIsTheFirst) {
  for (const char* number : {"", "zz", "100", "-1"}) {
    DeviceTexts texts = arm();
    texts.interface_number = number;
    EXPECT_EQ(serial_port_of(texts)->place->interface_number, 0U) << number;
  }
}

TEST(DeviceTexts, DevicesKeepTheirOrderWithTheirAddresses) {
  DeviceTexts other = arm();
  other.node = "/dev/ttyACM0";
  other.serial_number = "AB";
  std::vector<ReadDevice> read{*serial_port_of(other), *usb_device_of(arm()),
                               *hid_device_of(arm())};
  const auto found = with_addresses(std::move(read), {});
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].info.address.text, "serial:AB:1.2");
  EXPECT_EQ(found[1].info.address.text, "usb:ABC1");
  EXPECT_EQ(found[2].info.address.text, "hid:ABC1:1.2");
  EXPECT_EQ(found[1].info.port, "1-4");
  EXPECT_EQ(found[2].info.port, "1-4:1.2") << "what it was called before paths were";
}

}  // namespace
}  // namespace thimble::linux
