#include "sim/export/usb_descriptors.hpp"

#include <algorithm>
#include <array>
#include <string>

namespace thimble::sim {
namespace {

// USB 2.0, table 9-5; HID 1.11, 7.1.
constexpr std::uint8_t kDevice = 1;
constexpr std::uint8_t kConfiguration = 2;
constexpr std::uint8_t kString = 3;
constexpr std::uint8_t kInterface = 4;
constexpr std::uint8_t kEndpoint = 5;
constexpr std::uint8_t kHid = 0x21;
constexpr std::uint8_t kReport = 0x22;

constexpr std::size_t kMaxLetters = 126;  // a descriptor's length is one byte

std::uint8_t low(std::size_t value) noexcept { return static_cast<std::uint8_t>(value & 0xFFU); }
std::uint8_t high(std::size_t value) noexcept {
  return static_cast<std::uint8_t>(value >> 8U & 0xFFU);
}

DescriptorBytes device(const UsbPersona& persona) {
  const bus::BusDeviceInfo& info = persona.info;
  const std::uint8_t serial_number = info.serial_number.empty() ? 0 : 3;
  return {18,
          kDevice,
          0x00,
          0x02,  // USB 2.0
          persona.class_code,
          0,
          0,   // subclass, protocol
          64,  // largest packet of endpoint 0
          low(info.vendor_id),
          high(info.vendor_id),
          low(info.product_id),
          high(info.product_id),
          0x00,
          0x01,  // version
          1,
          2,
          serial_number,  // strings: manufacturer, product
          1};             // configurations
}

DescriptorBytes hid(const UsbPersona& persona) {
  const std::size_t size = persona.report_descriptor.size();
  return {9, kHid, 0x11, 0x01, 0, 1, kReport, low(size), high(size)};
}

void append(DescriptorBytes& bytes, const DescriptorBytes& more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

DescriptorBytes endpoint_descriptor(const bus::UsbEndpointInfo& endpoint) {
  return {7,
          kEndpoint,
          endpoint.address,
          static_cast<std::uint8_t>(endpoint.kind),
          low(endpoint.max_packet_bytes),
          high(endpoint.max_packet_bytes),
          endpoint.interval};
}

void append_interface(DescriptorBytes& bytes, const UsbInterface& interface,
                      const std::vector<bus::UsbEndpointInfo>& endpoints) {
  DescriptorBytes of_endpoints;
  std::size_t count = 0;
  for (const bus::UsbEndpointInfo& endpoint : endpoints) {
    if (endpoint.interface_number != interface.number) continue;
    append(of_endpoints, endpoint_descriptor(endpoint));
    ++count;
  }
  append(bytes, {9, kInterface, interface.number, 0, low(count), interface.class_code,
                 interface.subclass, interface.protocol, 0});
  append(bytes, interface.class_descriptors);
  append(bytes, of_endpoints);
}

DescriptorBytes configuration(const UsbPersona& persona) {
  const std::vector<UsbInterface> interfaces = interfaces_of(persona);
  // Self-powered, as far as 100 mA reach.
  DescriptorBytes bytes{9, kConfiguration, 0, 0, low(interfaces.size()), 1, 0, 0xC0, 50};
  for (const UsbInterface& interface : interfaces) {
    append_interface(bytes, interface, persona.info.endpoints);
  }
  bytes[2] = low(bytes.size());
  bytes[3] = high(bytes.size());
  return bytes;
}

// UTF-16, little-endian; what is beyond ASCII becomes a question mark.
DescriptorBytes text(const std::string& letters) {
  const std::size_t count = std::min(letters.size(), kMaxLetters);
  DescriptorBytes bytes{low(2 + 2 * count), kString};
  for (std::size_t i = 0; i < count; ++i) {
    const auto letter = static_cast<std::uint8_t>(letters[i]);
    bytes.push_back(letter < 0x80 ? letter : std::uint8_t{'?'});
    bytes.push_back(0);
  }
  return bytes;
}

DescriptorBytes string_descriptor(const bus::BusDeviceInfo& info, std::uint8_t index) {
  if (index == 0) return {4, kString, 0x09, 0x04};  // English, the only language
  const std::array<const std::string*, 3> strings{&info.manufacturer, &info.product,
                                                  &info.serial_number};
  return index <= strings.size() ? text(*strings[index - 1U]) : DescriptorBytes{};
}

}  // namespace

std::vector<UsbInterface> interfaces_of(const UsbPersona& persona) {
  if (!persona.interfaces.empty()) return persona.interfaces;
  const auto& endpoints = persona.info.endpoints;
  UsbInterface interface;
  interface.number = endpoints.empty() ? 0 : endpoints.front().interface_number;
  if (!persona.report_descriptor.empty()) {
    interface.class_code = kUsbClassHid;
    interface.class_descriptors = hid(persona);
  }
  return {interface};
}

DescriptorBytes usb_descriptor(const UsbPersona& persona, std::uint8_t type, std::uint8_t index) {
  const bool is_hid = !persona.report_descriptor.empty();
  if (type == kDevice && index == 0) return device(persona);
  if (type == kConfiguration && index == 0) return configuration(persona);
  if (type == kString) return string_descriptor(persona.info, index);
  if (type == kHid && is_hid) return hid(persona);
  if (type == kReport && is_hid) return persona.report_descriptor;
  return {};
}

}  // namespace thimble::sim
