#include "sim/export/usb_descriptors.hpp"

#include <gtest/gtest.h>

#include "hal/bus/usb_descriptor.hpp"
#include "sim/export/usb_requests.hpp"

namespace thimble::sim {
namespace {

using bus::UsbTransferKind;

constexpr std::uint8_t kDevice = 1;
constexpr std::uint8_t kConfiguration = 2;
constexpr std::uint8_t kString = 3;
constexpr std::uint8_t kHid = 0x21;
constexpr std::uint8_t kReport = 0x22;

UsbPersona bulk_device() {
  UsbPersona persona;
  persona.info.vendor_id = 0x0403;
  persona.info.product_id = 0xCB48;
  persona.info.manufacturer = "Maker";
  persona.info.product = "Arm";
  persona.info.endpoints = {{0, 0x81, UsbTransferKind::Bulk, 64, 0},
                            {0, 0x02, UsbTransferKind::Bulk, 64, 0}};
  return persona;
}

UsbPersona hid_device() {
  UsbPersona persona = bulk_device();
  persona.info.serial_number = "SN1";
  persona.info.endpoints = {{0, 0x81, UsbTransferKind::Interrupt, 64, 1}};
  persona.report_descriptor = DescriptorBytes(300, 0xC0);
  return persona;
}

TEST(UsbDescriptorsOfAModel, AreReadBackAsTheyWereMeant) {
  for (const UsbPersona& persona : {bulk_device(), hid_device()}) {
    DescriptorBytes all = usb_descriptor(persona, kDevice, 0);
    EXPECT_EQ(all.size(), 18U);
    const DescriptorBytes configuration = usb_descriptor(persona, kConfiguration, 0);
    EXPECT_EQ(configuration.size(), configuration[2] + 256U * configuration[3]);
    all.insert(all.end(), configuration.begin(), configuration.end());
    EXPECT_EQ(bus::parse_usb_descriptors(all, 1), persona.info.endpoints);
  }
}

TEST(UsbDescriptorsOfAModel, HaveEachEndpointBehindItsInterface) {
  UsbPersona persona = bulk_device();
  persona.class_code = 0xEF;
  persona.interfaces = {{0, 1, 2, 3, {3, 0x24, 9}}, {4, 5, 6, 7, {}}};
  persona.info.endpoints = {{4, 0x81, UsbTransferKind::Bulk, 64, 0},
                            {0, 0x02, UsbTransferKind::Interrupt, 8, 5},
                            {4, 0x03, UsbTransferKind::Bulk, 64, 0}};
  EXPECT_EQ(usb_descriptor(persona, kDevice, 0)[4], 0xEF);
  const DescriptorBytes bytes = usb_descriptor(persona, kConfiguration, 0);
  EXPECT_EQ(bytes, (DescriptorBytes{9, 2,    51,   0, 2,  1, 0, 0xC0, 50,  //
                                    9, 4,    0,    0, 1,  1, 2, 3,    0,   //
                                    3, 0x24, 9,                            //
                                    7, 5,    0x02, 3, 8,  0, 5,            //
                                    9, 4,    4,    0, 2,  5, 6, 7,    0,   //
                                    7, 5,    0x81, 2, 64, 0, 0,            //
                                    7, 5,    0x03, 2, 64, 0, 0}));
}

TEST(UsbDescriptorsOfAModel, SayWhoseClassItIs) {
  EXPECT_EQ(interfaces_of(bulk_device()).at(0).class_code, kUsbClassVendor);
  EXPECT_EQ(interfaces_of(hid_device()).at(0).class_code, kUsbClassHid);
  EXPECT_EQ(usb_descriptor(hid_device(), kConfiguration, 0)[9 + 5], kUsbClassHid);
  EXPECT_TRUE(usb_descriptor(bulk_device(), kHid, 0).empty());
  EXPECT_TRUE(usb_descriptor(bulk_device(), kReport, 0).empty());
  const DescriptorBytes hid = usb_descriptor(hid_device(), kHid, 0);
  EXPECT_EQ(hid[7] + 256 * hid[8], 300);
  EXPECT_EQ(usb_descriptor(hid_device(), kReport, 0).size(), 300U);
}

TEST(UsbDescriptorsOfAModel, HaveTheirStringsInUtf16) {
  EXPECT_EQ(usb_descriptor(hid_device(), kString, 3),
            (DescriptorBytes{8, 3, 'S', 0, 'N', 0, '1', 0}));
  EXPECT_EQ(usb_descriptor(hid_device(), kString, 0), (DescriptorBytes{4, 3, 9, 4}));
  EXPECT_TRUE(usb_descriptor(hid_device(), kString, 4).empty());
  EXPECT_EQ(usb_descriptor(bulk_device(), kDevice, 0)[16], 0) << "no serial number";
  UsbPersona persona = hid_device();
  persona.info.serial_number = std::string(500, 'x') + "\xC3\xA4";
  EXPECT_EQ(usb_descriptor(persona, kString, 3).size(), 254U);
  persona.info.serial_number = "\xC3\xA4";
  EXPECT_EQ(usb_descriptor(persona, kString, 3)[2], '?');
}

TEST(UsbRequestsOfAModel, AreAnsweredByTheStandard) {
  const UsbPersona persona = hid_device();
  std::uint8_t configuration = 0;
  const auto ask = [&](std::array<std::uint8_t, 8> setup) {
    const bus::UsbControlRequest request = control_request(setup, {});
    EXPECT_TRUE(is_standard(request));
    return answer_standard(persona, request, configuration);
  };
  EXPECT_EQ(ask({0x80, 8, 0, 0, 0, 0, 1, 0}), DescriptorBytes{0});
  EXPECT_EQ(ask({0x00, 9, 1, 0, 0, 0, 0, 0}), DescriptorBytes{});
  EXPECT_EQ(ask({0x80, 8, 0, 0, 0, 0, 1, 0}), DescriptorBytes{1});
  EXPECT_EQ(ask({0x00, 9, 2, 0, 0, 0, 0, 0}), std::nullopt);
  EXPECT_EQ(ask({0x80, 0, 0, 0, 0, 0, 2, 0}), (DescriptorBytes{1, 0}));
  EXPECT_EQ(ask({0x82, 0, 0, 0, 0x81, 0, 2, 0}), (DescriptorBytes{0, 0}));
  EXPECT_EQ(ask({0x02, 1, 0, 0, 0x81, 0, 0, 0}), DescriptorBytes{});
  EXPECT_EQ(ask({0x01, 11, 1, 0, 0, 0, 0, 0}), std::nullopt);
  EXPECT_EQ(ask({0x81, 6, 0, 0x22, 0, 0, 44, 1})->size(), 300U);
  EXPECT_EQ(ask({0x80, 6, 0, 6, 0, 0, 10, 0}), std::nullopt) << "device qualifier: full speed only";
  EXPECT_FALSE(is_standard(control_request({0x40, 0, 0, 0, 0, 0, 0, 0}, {})));
}

TEST(UsbRequestsOfAModel, KeepAsMuchDataAsThereIsRoomFor) {
  const std::vector<std::uint8_t> data(200, 7);
  const bus::UsbControlRequest request = control_request({0x21, 9, 4, 3, 0, 0, 200, 0}, data);
  EXPECT_EQ(request.length, 200);
  EXPECT_EQ(request.value, 0x0304);
  EXPECT_EQ(request.data.back(), 7);
}

}  // namespace
}  // namespace thimble::sim
