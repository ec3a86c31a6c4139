#include "sim/export/uhid_wire.hpp"

#include <gtest/gtest.h>
#include <linux/uhid.h>

#include <algorithm>
#include <cstring>
#include <random>
#include <string>

// The kernel's own header is the oracle.
namespace thimble::sim::uhid {
namespace {

using plugin::HidReportKind;

std::span<const std::uint8_t> bytes_of(const uhid_event& event) {
  return {reinterpret_cast<const std::uint8_t*>(&event), sizeof event};
}

// As the kernel takes what is shorter than the struct: extended with zeros.
uhid_event as_kernel(const Bytes& bytes) {
  uhid_event event{};
  EXPECT_LE(bytes.size(), sizeof event);
  std::memcpy(&event, bytes.data(), std::min(bytes.size(), sizeof event));
  return event;
}

TEST(UhidWire, HasTheKernelsSizes) {
  EXPECT_EQ(kEventBytes, sizeof(uhid_event));
  EXPECT_EQ(kMaxReportBytes, std::size_t{UHID_DATA_MAX});
}

TEST(UhidWire, KnowsEveryEventWithoutContent) {
  uhid_event event{};
  event.type = UHID_STOP;
  EXPECT_TRUE(std::holds_alternative<Stop>(*parse(bytes_of(event))));
  event.type = UHID_OPEN;
  EXPECT_TRUE(std::holds_alternative<Open>(*parse(bytes_of(event))));
  event.type = UHID_CLOSE;
  EXPECT_TRUE(std::holds_alternative<Close>(*parse(bytes_of(event))));
}

TEST(UhidWire, ReadsWhatTheKernelFoundOutAboutNumbers) {
  uhid_event event{};
  event.type = UHID_START;
  event.u.start.dev_flags = UHID_DEV_NUMBERED_OUTPUT_REPORTS;
  const auto start = std::get<Start>(*parse(bytes_of(event)));
  EXPECT_FALSE(start.has_feature_numbers);
  EXPECT_TRUE(start.has_output_numbers);
  EXPECT_FALSE(start.has_input_numbers);
}

TEST(UhidWire, ReadsAnOutputReport) {
  uhid_event event{};
  event.type = UHID_OUTPUT;
  event.u.output.size = 3;
  event.u.output.rtype = UHID_OUTPUT_REPORT;
  std::memcpy(event.u.output.data, "\x01\x02\x03\x04", 4);
  const auto output = std::get<Output>(*parse(bytes_of(event)));
  EXPECT_EQ(output.kind, HidReportKind::Output);
  EXPECT_EQ(std::vector(output.bytes.begin(), output.bytes.end()),
            (std::vector<std::uint8_t>{1, 2, 3}));
}

TEST(UhidWire, ReadsRequests) {
  uhid_event event{};
  event.type = UHID_GET_REPORT;
  event.u.get_report = {.id = 77, .rnum = 3, .rtype = UHID_FEATURE_REPORT};
  const auto get = std::get<GetReport>(*parse(bytes_of(event)));
  EXPECT_EQ(get.id, 77U);
  EXPECT_EQ(get.number, 3);
  EXPECT_EQ(get.kind, HidReportKind::Feature);

  event = {};
  event.type = UHID_SET_REPORT;
  event.u.set_report = {.id = 78, .rnum = 4, .rtype = UHID_INPUT_REPORT, .size = 2, .data = {4, 9}};
  const auto set = std::get<SetReport>(*parse(bytes_of(event)));
  EXPECT_EQ(set.id, 78U);
  EXPECT_EQ(set.number, 4);
  EXPECT_EQ(set.kind, HidReportKind::Input);
  EXPECT_EQ(std::vector(set.bytes.begin(), set.bytes.end()), (std::vector<std::uint8_t>{4, 9}));
}

TEST(UhidWire, IsNothingForWhatCannotBe) {
  EXPECT_FALSE(parse({}));
  uhid_event event{};
  for (const std::uint32_t type : {0U, 1U, 7U, 8U, 10U, 11U, 12U, 14U, 15U, 0xFFFFFFFFU}) {
    event.type = type;
    EXPECT_FALSE(parse(bytes_of(event))) << type;
  }
  event.type = UHID_OUTPUT;
  event.u.output.size = UHID_DATA_MAX + 1;
  event.u.output.rtype = UHID_OUTPUT_REPORT;
  EXPECT_FALSE(parse(bytes_of(event)));
  event.u.output.size = 1;
  event.u.output.rtype = 3;
  EXPECT_FALSE(parse(bytes_of(event)));
}

TEST(UhidWire, TakesAnyBytesAndStaysWithinThem) {
  std::mt19937 random(8);
  for (int i = 0; i < 5000; ++i) {
    const std::size_t size = i % 4 == 0 ? kEventBytes : random() % 64;
    std::vector<std::uint8_t> bytes(size);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    if (bytes.size() >= 4) bytes[1] = bytes[2] = bytes[3] = 0;
    if (!bytes.empty()) bytes[0] = static_cast<std::uint8_t>(bytes[0] % 16);
    const auto event = parse(bytes);
    const auto* set = event ? std::get_if<SetReport>(&*event) : nullptr;
    if (set == nullptr || set->bytes.empty()) continue;
    EXPECT_GE(set->bytes.data(), bytes.data());
    EXPECT_LE(set->bytes.data() + set->bytes.size(), bytes.data() + bytes.size());
  }
}

TEST(UhidWire, MakesADevice) {
  bus::BusDeviceInfo device;
  device.product = "Arm";
  device.serial_number = "SN1";
  device.address = {"sim:arm"};
  device.vendor_id = 0x1234;
  device.product_id = 6;
  const std::vector<std::uint8_t> descriptor{0xC0, 0xC1};
  const uhid_event event = as_kernel(create(device, descriptor));
  EXPECT_EQ(event.type, std::uint32_t{UHID_CREATE2});
  EXPECT_STREQ(reinterpret_cast<const char*>(event.u.create2.name), "Arm");
  EXPECT_STREQ(reinterpret_cast<const char*>(event.u.create2.phys), "sim:arm");
  EXPECT_STREQ(reinterpret_cast<const char*>(event.u.create2.uniq), "SN1");
  EXPECT_EQ(event.u.create2.rd_size, 2);
  EXPECT_EQ(event.u.create2.bus, 3);
  EXPECT_EQ(event.u.create2.vendor, 0x1234U);
  EXPECT_EQ(event.u.create2.product, 6U);
  EXPECT_EQ(event.u.create2.rd_data[1], 0xC1);
}

TEST(UhidWire, CutsTextsThatAreTooLong) {
  bus::BusDeviceInfo device;
  device.product = device.serial_number = device.address.text = std::string(300, 'x');
  const uhid_event event = as_kernel(create(device, {}));
  EXPECT_EQ(std::strlen(reinterpret_cast<const char*>(event.u.create2.name)), 127U);
  EXPECT_EQ(std::strlen(reinterpret_cast<const char*>(event.u.create2.phys)), 63U);
  EXPECT_EQ(std::strlen(reinterpret_cast<const char*>(event.u.create2.uniq)), 63U);
}

TEST(UhidWire, SendsReportsAndReplies) {
  const std::vector<std::uint8_t> report{7, 8, 9};
  uhid_event event = as_kernel(input(report));
  EXPECT_EQ(event.type, std::uint32_t{UHID_INPUT2});
  EXPECT_EQ(event.u.input2.size, 3);
  EXPECT_EQ(event.u.input2.data[2], 9);

  event = as_kernel(get_report_reply(5, 0, report));
  EXPECT_EQ(event.type, std::uint32_t{UHID_GET_REPORT_REPLY});
  EXPECT_EQ(event.u.get_report_reply.id, 5U);
  EXPECT_EQ(event.u.get_report_reply.err, 0);
  EXPECT_EQ(event.u.get_report_reply.size, 3);
  EXPECT_EQ(event.u.get_report_reply.data[0], 7);

  event = as_kernel(set_report_reply(6, EPIPE));
  EXPECT_EQ(event.type, std::uint32_t{UHID_SET_REPORT_REPLY});
  EXPECT_EQ(event.u.set_report_reply.id, 6U);
  EXPECT_EQ(event.u.set_report_reply.err, EPIPE);

  EXPECT_EQ(as_kernel(destroy()).type, std::uint32_t{UHID_DESTROY});
}

}  // namespace
}  // namespace thimble::sim::uhid
