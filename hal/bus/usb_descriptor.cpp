#include "hal/bus/usb_descriptor.hpp"

#include <algorithm>

namespace thimble::bus {
namespace {

// USB 2.0, tables 9-5, 9-10, 9-12 and 9-13: types, lengths and places of fields.
constexpr std::uint8_t kConfiguration = 2;
constexpr std::uint8_t kInterface = 4;
constexpr std::uint8_t kEndpoint = 5;
constexpr std::size_t kHeaderBytes = 2;
constexpr std::size_t kConfigurationBytes = 9;
constexpr std::size_t kInterfaceBytes = 9;
constexpr std::size_t kEndpointBytes = 7;
constexpr std::size_t kConfigurationValue = 5;
constexpr std::size_t kInterfaceNumber = 2;
constexpr std::size_t kAlternateSetting = 3;
constexpr std::uint8_t kKindBits = 0x03;
constexpr std::uint16_t kPacketBits = 0x07FF;  // above: packets per microframe
constexpr std::size_t kMaxEndpoints = 30;      // 15 each way, and endpoint 0

struct Reader {
  std::uint8_t wanted{0};
  bool is_wanted{false};      // the configuration that is being read
  bool is_first_form{false};  // its interface as it is before any request
  std::uint8_t interface_number{0};
  bool is_found{false};
  std::vector<UsbEndpointInfo> endpoints;
};

UsbEndpointInfo endpoint_of(std::span<const std::uint8_t> bytes, std::uint8_t interface_number) {
  const auto packet_bytes = static_cast<std::uint16_t>(bytes[4] | bytes[5] << 8U);
  return {.interface_number = interface_number,
          .address = bytes[2],
          .kind = static_cast<UsbTransferKind>(bytes[3] & kKindBits),
          .max_packet_bytes = static_cast<std::uint16_t>(packet_bytes & kPacketBits),
          .interval = bytes[6]};
}

// An address is one endpoint's of a configuration: the kernel passes over who repeats it
// (drivers/usb/core/config.c, config_endpoint_is_duplicate()), and claims what came first.
void take(Reader& reader, const UsbEndpointInfo& endpoint) {
  const bool is_repeated =
      std::any_of(reader.endpoints.begin(), reader.endpoints.end(),
                  [&](const UsbEndpointInfo& known) { return known.address == endpoint.address; });
  if (is_repeated || reader.endpoints.size() == kMaxEndpoints) return;
  reader.endpoints.push_back(endpoint);
}

// False when it is too short for what it says it is.
bool take(Reader& reader, std::span<const std::uint8_t> descriptor) {
  switch (descriptor[1]) {
    case kConfiguration:
      if (descriptor.size() < kConfigurationBytes) return false;
      reader.is_wanted = descriptor[kConfigurationValue] == reader.wanted;
      reader.is_found = reader.is_found || reader.is_wanted;
      reader.is_first_form = false;
      return true;
    case kInterface:
      if (descriptor.size() < kInterfaceBytes) return false;
      reader.interface_number = descriptor[kInterfaceNumber];
      reader.is_first_form = descriptor[kAlternateSetting] == 0;
      return true;
    case kEndpoint:
      if (descriptor.size() < kEndpointBytes) return false;
      if (!reader.is_wanted || !reader.is_first_form) return true;
      take(reader, endpoint_of(descriptor, reader.interface_number));
      return true;
    default:
      return true;  // a class's or a vendor's, and the device's own
  }
}

}  // namespace

std::optional<std::vector<UsbEndpointInfo>> parse_usb_descriptors(
    std::span<const std::uint8_t> bytes, std::uint8_t configuration) {
  Reader reader;
  reader.wanted = configuration;
  while (!bytes.empty()) {
    const std::size_t size = bytes[0];
    if (size < kHeaderBytes || size > bytes.size()) return std::nullopt;
    if (!take(reader, bytes.first(size))) return std::nullopt;
    bytes = bytes.subspan(size);
  }
  if (!reader.is_found) return std::nullopt;
  return reader.endpoints;
}

}  // namespace thimble::bus
