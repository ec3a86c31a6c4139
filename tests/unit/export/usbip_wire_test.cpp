#include "sim/export/usbip_wire.hpp"

#include <gtest/gtest.h>

#include <initializer_list>
#include <random>
#include <string>

// Headers captured on a wire stand in the kernel's Documentation/usb/usbip_protocol.rst, section
// EXAMPLE.
namespace thimble::sim::usbip {
namespace {

Bytes words(std::initializer_list<std::uint32_t> values) {
  Bytes bytes;
  for (const std::uint32_t value : values) {
    for (int shift = 24; shift >= 0; shift -= 8) {
      bytes.push_back(static_cast<std::uint8_t>(value >> static_cast<unsigned>(shift)));
    }
  }
  return bytes;
}

std::span<const std::uint8_t, kHeaderBytes> header(const Bytes& bytes) {
  return std::span(bytes).first<kHeaderBytes>();
}

const Bytes kInterruptIn = words({1, 0xd05, 0x1000f, 1, 1, 0x200, 0x40, 0xffffffff, 0, 4, 0, 0});
const Bytes kInterruptOut = words({1, 0xd06, 0x1000f, 0, 1, 0, 0x40, 0xffffffff, 0, 4, 0, 0});

TEST(UsbipWire, ReadsSubmitsAsTheyWereCaptured) {
  const auto in = std::get<Submit>(*parse_header(header(kInterruptIn)));
  EXPECT_EQ(in.seqnum, 0xd05U);
  EXPECT_EQ(in.device_id, 0x1000fU);
  EXPECT_TRUE(in.is_in);
  EXPECT_EQ(in.endpoint, 1);
  EXPECT_EQ(in.flags, 0x200U);
  EXPECT_EQ(in.length, 0x40U);
  const auto out = std::get<Submit>(*parse_header(header(kInterruptOut)));
  EXPECT_FALSE(out.is_in);
  EXPECT_EQ(out.seqnum, 0xd06U);
}

TEST(UsbipWire, RepliesAsWasCaptured) {
  const auto out = std::get<Submit>(*parse_header(header(kInterruptOut)));
  Bytes expected = words({3, 0xd06, 0, 0, 0, 0, 0x40, 0, 0, 0, 0, 0});
  EXPECT_EQ(submit_reply(out, 0, 0x40, {}), expected);
  Submit in = std::get<Submit>(*parse_header(header(kInterruptIn)));
  in.packets = 0xffffffff;
  expected = words({3, 0xd05, 0, 0, 0, 0, 2, 0, 0xffffffff, 0, 0, 0});
  expected.insert(expected.end(), {0xAB, 0xCD});
  EXPECT_EQ(submit_reply(in, 0, 2, Bytes{0xAB, 0xCD}), expected);
}

TEST(UsbipWire, ReadsAnUnlinkAndRepliesToIt) {
  const auto unlink =
      std::get<Unlink>(*parse_header(header(words({2, 9, 0x10001, 0, 0, 8, 0, 0, 0, 0, 0, 0}))));
  EXPECT_EQ(unlink.seqnum, 9U);
  EXPECT_EQ(unlink.unlinked, 8U);
  EXPECT_EQ(unlink_reply(9, -104), words({4, 9, 0, 0, 0, 0xffffff98, 0, 0, 0, 0, 0, 0}));
}

TEST(UsbipWire, ReadsTheSetupPacketOfAControlTransfer) {
  const auto submit = std::get<Submit>(
      *parse_header(header(words({1, 1, 0x10001, 1, 0, 0, 18, 0, 0, 0, 0x80060001, 0x00001200}))));
  EXPECT_EQ(submit.setup, (std::array<std::uint8_t, 8>{0x80, 6, 0, 1, 0, 0, 0x12, 0}));
  EXPECT_FALSE(submit.is_isochronous());
}

TEST(UsbipWire, RefusesHeadersThatCannotBe) {
  EXPECT_FALSE(parse_header(header(words({3, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}))));
  EXPECT_FALSE(parse_header(header(words({1, 1, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0}))));
  EXPECT_FALSE(parse_header(header(words({1, 1, 0, 0, 16, 0, 0, 0, 0, 0, 0, 0}))));
}

TEST(UsbipWire, ReadsRequestsOfADevice) {
  const Bytes list = words({0x01118005, 0});
  EXPECT_EQ(op_request_bytes(list), kOpHeaderBytes);
  EXPECT_TRUE(std::holds_alternative<DevlistRequest>(*parse_op_request(list)));
  Bytes import = words({0x01118003, 0});
  EXPECT_EQ(op_request_bytes(import), 40U);
  EXPECT_FALSE(parse_op_request(import)) << "not whole";
  import.resize(40);
  import[8] = '1';
  import[9] = '-';
  import[10] = '1';
  EXPECT_EQ(std::get<ImportRequest>(*parse_op_request(import)).bus_id, "1-1");
  EXPECT_FALSE(op_request_bytes(words({0x01108005, 0}))) << "another version";
  EXPECT_FALSE(op_request_bytes(words({0x01110005, 0}))) << "a reply";
}

TEST(UsbipWire, DescribesTheDeviceInBothReplies) {
  DeviceRecord device;
  device.path = "sim:arm";
  device.bus_id = "1-1";
  device.vendor_id = 0x1234;
  device.product_id = 6;
  device.class_code = 2;
  device.interfaces = {{2, 2, 1}, {10, 0, 0}};
  const Bytes list = devlist_reply(&device);
  ASSERT_EQ(list.size(), 12U + 312 + 8);
  EXPECT_EQ(Bytes(list.begin(), list.begin() + 12), words({0x01110005, 0, 1}));
  EXPECT_EQ(std::string(list.begin() + 12, list.begin() + 20), std::string("sim:arm\0", 8));
  EXPECT_EQ(std::string(list.begin() + 0x10C, list.begin() + 0x110), std::string("1-1\0", 4));
  EXPECT_EQ(Bytes(list.begin() + 0x134, list.begin() + 0x13E),
            (Bytes{0, 0, 0, 2, 0x12, 0x34, 0, 6, 0, 0}));
  EXPECT_EQ(Bytes(list.begin() + 0x13E, list.begin() + 0x144), (Bytes{2, 0, 0, 1, 1, 2}));
  EXPECT_EQ(Bytes(list.begin() + 0x144, list.end()), (Bytes{2, 2, 1, 0, 10, 0, 0, 0}));
  const Bytes import = import_reply(&device);
  ASSERT_EQ(import.size(), 8U + 312);
  EXPECT_EQ(Bytes(import.begin() + 8, import.end()), Bytes(list.begin() + 12, list.end() - 8));
  EXPECT_EQ(devlist_reply(nullptr), words({0x01110005, 0, 0}));
  EXPECT_EQ(import_reply(nullptr), words({0x01110003, 1}));
}

TEST(UsbipWire, CutsTextsThatAreTooLong) {
  DeviceRecord device;
  device.path = device.bus_id = std::string(1000, 'x');
  EXPECT_EQ(import_reply(&device).size(), 320U);
  EXPECT_EQ(import_reply(&device)[8 + 255], 0);
}

TEST(UsbipWire, TakesAnyBytes) {
  std::mt19937 random(4);
  for (int i = 0; i < 20000; ++i) {
    Bytes bytes(kHeaderBytes);
    for (std::uint8_t& byte : bytes)
      byte = static_cast<std::uint8_t>(i % 2 == 0 ? random() : random() % 3);
    const auto parsed = parse_header(header(bytes));
    if (const auto* submit = parsed ? std::get_if<Submit>(&*parsed) : nullptr) {
      EXPECT_LT(submit->endpoint, 16);
    }
    (void)parse_op_request(std::span(bytes).first(bytes[0] % kHeaderBytes));
  }
}

}  // namespace
}  // namespace thimble::sim::usbip
