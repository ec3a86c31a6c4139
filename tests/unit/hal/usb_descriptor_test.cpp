#include "hal/bus/usb_descriptor.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace thimble::bus {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes joined(const std::vector<Bytes>& parts) {
  Bytes all;
  for (const Bytes& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

const Bytes kDevice{18, 1, 0, 2, 0xFF, 0, 0, 64, 0x03, 0x04, 0x48, 0xCB, 0, 1, 1, 2, 3, 1};
Bytes configuration(std::uint8_t number) { return {9, 2, 32, 0, 1, number, 0, 0x80, 50}; }
Bytes interface(std::uint8_t number, std::uint8_t alternate) {
  return {9, 4, number, alternate, 2, 0xFF, 0xFF, 0xFF, 0};
}
Bytes endpoint(std::uint8_t address, std::uint8_t kind, std::uint16_t packet_bytes,
               std::uint8_t interval) {
  return {7,
          5,
          address,
          kind,
          static_cast<std::uint8_t>(packet_bytes & 0xFFU),
          static_cast<std::uint8_t>(packet_bytes >> 8U),
          interval};
}

TEST(UsbDescriptors, TellTheEndpointsInTheirOrder) {
  const auto endpoints = parse_usb_descriptors(
      joined({kDevice, configuration(1), interface(0, 0), endpoint(0x81, 2, 64, 0),
              endpoint(0x02, 2, 64, 0), interface(1, 0), endpoint(0x83, 3, 14, 1)}),
      1);
  ASSERT_TRUE(endpoints.has_value());
  EXPECT_EQ(*endpoints,
            (std::vector<UsbEndpointInfo>{{0, 0x81, UsbTransferKind::Bulk, 64, 0},
                                          {0, 0x02, UsbTransferKind::Bulk, 64, 0},
                                          {1, 0x83, UsbTransferKind::Interrupt, 14, 1}}));
}

TEST(UsbDescriptors, LeaveOutOtherConfigurationsAndAlternateSettings) {
  const Bytes bytes = joined({kDevice, configuration(1), interface(0, 0), endpoint(0x81, 2, 64, 0),
                              interface(0, 1), endpoint(0x82, 2, 64, 0), configuration(2),
                              interface(0, 0), endpoint(0x83, 2, 64, 0)});
  EXPECT_EQ(parse_usb_descriptors(bytes, 1)->front().address, 0x81);
  EXPECT_EQ(parse_usb_descriptors(bytes, 1)->size(), 1U);
  EXPECT_EQ(parse_usb_descriptors(bytes, 2)->front().address, 0x83);
  EXPECT_FALSE(parse_usb_descriptors(bytes, 3).has_value());
}

// As the kernel: else a device could show a pipe that nobody can open before one that is good.
TEST(UsbDescriptors, TellARepeatedAddressOnceAsItWasFirst) {
  const auto endpoints = parse_usb_descriptors(
      joined({configuration(1), interface(0, 0), endpoint(0x81, 2, 64, 0), endpoint(0x81, 3, 1, 1),
              endpoint(0x01, 2, 64, 0), interface(1, 0), endpoint(0x81, 1, 8, 1)}),
      1);
  ASSERT_TRUE(endpoints.has_value());
  EXPECT_EQ(*endpoints, (std::vector<UsbEndpointInfo>{{0, 0x81, UsbTransferKind::Bulk, 64, 0},
                                                      {0, 0x01, UsbTransferKind::Bulk, 64, 0}}));
}

TEST(UsbDescriptors, TakeThePacketLengthWithoutThePacketsPerMicroframe) {
  const auto endpoints = parse_usb_descriptors(
      joined({configuration(1), interface(0, 0), endpoint(0x81, 3, 0x1400, 1)}), 1);
  EXPECT_EQ(endpoints->front().max_packet_bytes, 1024);
}

TEST(UsbDescriptors, PassOverThoseOfClassesAndVendors) {
  const auto endpoints = parse_usb_descriptors(joined({configuration(1),
                                                       interface(0, 0),
                                                       {9, 0x21, 0x11, 1, 0, 1, 0x22, 40, 0},
                                                       {2, 0xFF},
                                                       endpoint(0x81, 3, 14, 1)}),
                                               1);
  EXPECT_EQ(endpoints->size(), 1U);
}

TEST(UsbDescriptors, AreNothingWhenALengthDoesNotFit) {
  const Bytes good = joined({kDevice, configuration(1), interface(0, 0), endpoint(0x81, 2, 64, 0)});
  for (std::size_t size = kDevice.size() + 10; size < good.size(); ++size) {
    const bool is_whole = size == good.size() - 7;  // without the endpoint
    EXPECT_EQ(parse_usb_descriptors(std::span(good).first(size), 1).has_value(), is_whole) << size;
  }
  EXPECT_FALSE(parse_usb_descriptors(Bytes{0, 5}, 1).has_value());
  EXPECT_FALSE(parse_usb_descriptors(Bytes{1}, 1).has_value());
  EXPECT_FALSE(parse_usb_descriptors(joined({configuration(1), {3, 5, 0x81}}), 1).has_value());
  EXPECT_FALSE(parse_usb_descriptors({}, 1).has_value());
}

TEST(UsbDescriptors, AreTakenWhateverTheirBytesAre) {
  std::mt19937 random(8);
  for (int i = 0; i < 20000; ++i) {
    std::vector<Bytes> parts{configuration(1)};
    for (std::size_t part = 0; part < random() % 60; ++part) {
      switch (random() % 3) {
        case 0:
          parts.push_back(interface(0, static_cast<std::uint8_t>(random() % 2)));
          break;
        case 1:
          parts.push_back(endpoint(static_cast<std::uint8_t>(random()), 2, 64, 0));
          break;
        default:
          parts.push_back({2, static_cast<std::uint8_t>(random())});
      }
    }
    Bytes bytes = joined(parts);
    if (random() % 2 == 0) bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    const auto endpoints = parse_usb_descriptors(bytes, 1);
    std::set<std::uint8_t> addresses;
    const auto found = endpoints.value_or(std::vector<UsbEndpointInfo>{});
    for (const UsbEndpointInfo& endpoint : found) addresses.insert(endpoint.address);
    EXPECT_EQ(addresses.size(), found.size()) << "each one once";
    EXPECT_LE(found.size(), 30U);
  }
}

}  // namespace
}  // namespace thimble::bus
