#include "tests/vm/speed/echo.hpp"

#include <algorithm>

#include "drivers/falcon/falcon_wire.hpp"
#include "drivers/phantom/phantom_wire.hpp"
#include "drivers/phantom/text_wire.hpp"

namespace thimble::speed {
namespace {

bus::BusDeviceInfo echo_of(bus::BusKind kind, std::uint16_t vendor, std::uint16_t product) {
  bus::BusDeviceInfo info;
  info.kind = kind;
  info.vendor_id = vendor;
  info.product_id = product;
  info.product = "echo";
  info.serial_number = kSerial;
  return info;
}

}  // namespace

void Echo::take(std::span<const std::uint8_t> bytes) noexcept {
  size_ = std::min(bytes.size(), bytes_.size());
  std::copy_n(bytes.begin(), size_, bytes_.begin());
}

std::size_t Echo::give(std::span<std::uint8_t> out) noexcept {
  const std::size_t size = std::min(size_, out.size());
  std::copy_n(bytes_.begin(), size, out.begin());
  size_ = 0;
  return size;
}

bus::BusDeviceInfo EchoHid::describe() const {
  bus::BusDeviceInfo info =
      echo_of(bus::BusKind::Hid, phantom::wire::kMbedVendorId, phantom::wire::kMbedProductId);
  info.input_report_bytes = kExchangeBytes;
  info.output_report_bytes = kExchangeBytes;
  return info;
}

bus::BusDeviceInfo EchoUsb::describe() const {
  bus::BusDeviceInfo info =
      echo_of(bus::BusKind::Usb, falcon::wire::kVendorId, falcon::wire::kProductId);
  for (const std::uint8_t address : {kBulkIn, kBulkOut}) {
    info.endpoints.push_back(
        {.address = address, .max_packet_bytes = falcon::wire::kUsbPacketBytes});
  }
  return info;
}

bus::BusDeviceInfo EchoSerial::describe() const {
  return echo_of(bus::BusKind::Serial, phantom::text::kVendorId, phantom::text::kProductId);
}

plugin::UsbHandshake EchoUsb::out_packet(std::uint8_t,
                                         std::span<const std::uint8_t> bytes) noexcept {
  echo_.take(bytes);
  return plugin::UsbHandshake::Ack;
}

plugin::UsbAnswer EchoUsb::in_packet(std::uint8_t, std::span<std::uint8_t> out) noexcept {
  const std::size_t size = echo_.give(out);
  if (size == 0) return {};
  return {plugin::UsbHandshake::Ack, size};
}

}  // namespace thimble::speed
