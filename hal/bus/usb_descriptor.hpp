#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hal/rt/static_vector.hpp"

namespace thimble::bus {

// USB 2.0, 5.8.3: a bulk packet at high speed; at full speed no packet has more than 64 bytes.
inline constexpr std::size_t kMaxUsbPacketBytes = 512;
// USB 2.0, table 9-13: an endpoint's address has its direction in bit 7 and its number below.
inline constexpr std::uint8_t kUsbInBit = 0x80;

// The values are those of bmAttributes, USB 2.0, table 9-13.
enum class UsbTransferKind : std::uint8_t { Control = 0, Isochronous = 1, Bulk = 2, Interrupt = 3 };

[[nodiscard]] constexpr bool is_usb_in(std::uint8_t endpoint) noexcept {
  return (endpoint & kUsbInBit) != 0;
}

// One endpoint as the device's descriptors tell of it; the device may lie.
struct UsbEndpointInfo {
  std::uint8_t interface_number{0};
  std::uint8_t address{0};  // 0x81: endpoint 1, device to host; 0x02: endpoint 2, host to device
  UsbTransferKind kind{UsbTransferKind::Bulk};
  std::uint16_t max_packet_bytes{0};
  std::uint8_t interval{0};  // bInterval; at full speed the frames (1 ms) between two interrupts
  bool operator==(const UsbEndpointInfo&) const = default;
};

// The endpoints of one configuration of a device, from all its descriptors as the kernel keeps them
// (sysfs, `descriptors`): the device's, then those of each configuration; USB 2.0, 9.5 and 9.6. An
// interface shows as it is before anybody asks for an alternate setting of it. Nothing when a
// length does not fit, or without that configuration; a device has at most 30 endpoints for us,
// those beyond are left out. Total: any bytes. Thread: any. Not RT. Pure.
[[nodiscard]] std::optional<std::vector<UsbEndpointInfo>> parse_usb_descriptors(
    std::span<const std::uint8_t> bytes, std::uint8_t configuration);

// What a driver wants to do with one endpoint.
enum class UsbDelivery : std::uint8_t {
  Newest,  // only the newest packet is kept, as of a device whose packet says everything
  Every,   // packets wait in order, for a device whose bytes are a stream
};

struct UsbPipe {
  std::uint8_t endpoint{0};
  UsbDelivery delivery{UsbDelivery::Newest};
};

inline constexpr std::size_t kMaxUsbPipes = 4;  // ours: in and out, bulk and interrupt

// What a driver claims of a device: one interface and the endpoints of it that it uses.
struct UsbClaim {
  std::uint8_t interface_number{0};
  rt::StaticVector<UsbPipe, kMaxUsbPipes> pipes;
};

}  // namespace thimble::bus
