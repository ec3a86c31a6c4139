#include "hal/linux/device_texts.hpp"

#include <charconv>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>

#include "hal/bus/hid_report_descriptor.hpp"
#include "hal/bus/usb_descriptor.hpp"
#include "hal/linux/hid_address.hpp"
#include "hal/linux/printable_text.hpp"

namespace thimble::linux {
namespace {

std::string word_of(std::string_view text) { return printable_text(text.substr(0, kMaxTextBytes)); }

template <class Number>
std::optional<Number> number_of(std::string_view text, int base) {
  Number number{0};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number, base);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

// HID_ID=0003:00001234:00000006, bus, vendor and product.
bool read_ids(const std::string& text, bus::BusDeviceInfo& info) {
  const std::size_t first = text.find(':');
  const std::size_t second = text.find(':', first == std::string::npos ? first : first + 1);
  if (second == std::string::npos) return false;
  const auto vendor =
      number_of<std::uint32_t>(std::string_view(text).substr(first + 1, second - first - 1), 16);
  const auto product = number_of<std::uint32_t>(std::string_view(text).substr(second + 1), 16);
  if (!vendor || !product || *vendor > 0xFFFF || *product > 0xFFFF) return false;
  info.vendor_id = static_cast<std::uint16_t>(*vendor);
  info.product_id = static_cast<std::uint16_t>(*product);
  return true;
}

bool read_usb_ids(const DeviceTexts& texts, bus::BusDeviceInfo& info) {
  const auto vendor = number_of<std::uint16_t>(texts.vendor_id, 16);
  const auto product = number_of<std::uint16_t>(texts.product_id, 16);
  if (!vendor || !product) return false;
  info.vendor_id = *vendor;
  info.product_id = *product;
  return true;
}

void read_strings(const DeviceTexts& texts, bus::BusDeviceInfo& info) {
  info.manufacturer = word_of(texts.manufacturer);
  info.product = word_of(texts.product);
  info.serial_number = word_of(texts.serial_number);
}

void read_lengths(const DeviceTexts& texts, bus::BusDeviceInfo& info) {
  const auto lengths = bus::parse_report_descriptor(texts.report_descriptor);
  if (!lengths) return;
  info.input_report_bytes = lengths->input_bytes;
  info.output_report_bytes = lengths->output_bytes;
  info.has_report_ids = lengths->has_report_ids;
}

DevicePlace place_of(const DeviceTexts& texts, const bus::BusDeviceInfo& info) {
  DevicePlace place;
  place.port = texts.port;
  if (texts.is_on_usb) {
    place.interface_number = number_of<std::uint8_t>(texts.interface_number, 16).value_or(0);
    place.path = texts.path;
    place.own_name = texts.name;
  }
  place.serial_number = info.serial_number;
  return place;
}

// Those of one kind, by their places among each other.
void address(std::vector<ReadDevice>& read, bus::BusKind kind,
             std::vector<bus::DeviceAddress> (*addresses_of)(std::span<const DevicePlace>)) {
  const auto is_meant = [&](const ReadDevice& one) {
    return one.place && one.device.info.kind == kind;
  };
  std::vector<DevicePlace> places;
  for (const ReadDevice& one : read) {
    if (is_meant(one)) places.push_back(*one.place);
  }
  const std::vector<bus::DeviceAddress> addresses = addresses_of(places);
  std::size_t next = 0;
  for (ReadDevice& one : read) {
    if (!is_meant(one)) continue;
    one.device.info.address = addresses[next++];
    if (!one.place->path.empty()) one.device.info.port = port_name(*one.place);
  }
}

}  // namespace

std::optional<ReadDevice> hid_device_of(const DeviceTexts& texts) {
  ReadDevice found;
  found.device.node = texts.node;
  found.device.hiddev = texts.hiddev;
  bus::BusDeviceInfo& info = found.device.info;
  info.kind = bus::BusKind::Hid;
  if (texts.node.empty() || !read_ids(texts.hid_id, info)) return std::nullopt;
  if (texts.is_on_usb) {
    read_strings(texts, info);
  } else {
    info.product = word_of(texts.hid_name);
  }
  if (info.serial_number.empty()) info.serial_number = word_of(texts.hid_uniq);
  found.place = place_of(texts, info);
  read_lengths(texts, info);
  return found;
}

std::optional<ReadDevice> serial_port_of(const DeviceTexts& texts) {
  ReadDevice found;
  found.device.node = texts.node;
  bus::BusDeviceInfo& info = found.device.info;
  info.kind = bus::BusKind::Serial;
  if (texts.node.empty() || !read_usb_ids(texts, info)) return std::nullopt;
  read_strings(texts, info);
  found.place = place_of(texts, info);
  return found;
}

std::optional<ReadDevice> usb_device_of(const DeviceTexts& texts) {
  ReadDevice found;
  found.device.node = texts.node;
  bus::BusDeviceInfo& info = found.device.info;
  if (texts.node.empty() || !read_usb_ids(texts, info)) return std::nullopt;
  info.kind = bus::BusKind::Usb;
  read_strings(texts, info);
  found.place = place_of(texts, info);
  found.place->interface_number = 0;  // it is all of them
  const auto configuration = number_of<std::uint8_t>(texts.configuration, 10).value_or(0);
  const auto* first = reinterpret_cast<const std::uint8_t*>(texts.descriptors.data());
  auto endpoints = bus::parse_usb_descriptors({first, texts.descriptors.size()}, configuration);
  if (endpoints) info.endpoints = std::move(*endpoints);
  return found;
}

std::vector<FoundDevice> with_addresses(
    std::vector<ReadDevice> read, const std::function<bool(const bus::BusDeviceInfo&)>& is_arm) {
  for (ReadDevice& one : read) {
    if (one.place && is_arm) one.place->is_arm = is_arm(one.device.info);
  }
  address(read, bus::BusKind::Hid, &hid_addresses);
  address(read, bus::BusKind::Serial, &serial_addresses);
  address(read, bus::BusKind::Usb, &usb_addresses);
  std::vector<FoundDevice> found;
  found.reserve(read.size());
  for (ReadDevice& one : read) found.push_back(std::move(one.device));
  return found;
}

}  // namespace thimble::linux
