#include "sim/export/usb_requests.hpp"

#include <algorithm>

namespace thimble::sim {
namespace {

// USB 2.0, table 9-4.
constexpr std::uint8_t kGetStatus = 0;
constexpr std::uint8_t kClearFeature = 1;
constexpr std::uint8_t kSetFeature = 3;
constexpr std::uint8_t kGetDescriptor = 6;
constexpr std::uint8_t kGetConfiguration = 8;
constexpr std::uint8_t kSetConfiguration = 9;
constexpr std::uint8_t kGetInterface = 10;
constexpr std::uint8_t kSetInterface = 11;

constexpr std::uint16_t kEndpointHalt = 0;  // table 9-6
constexpr std::uint8_t kToEndpoint = 2;
constexpr std::uint8_t kRecipientBits = 0x1F;  // of bmRequestType
constexpr std::uint8_t kSelfPowered = 1;

bool has_interface(const UsbPersona& persona, std::uint16_t number) {
  const std::vector<UsbInterface> interfaces = interfaces_of(persona);
  return std::any_of(interfaces.begin(), interfaces.end(),
                     [&](const UsbInterface& interface) { return interface.number == number; });
}

std::optional<DescriptorBytes> answer_in(const UsbPersona& persona,
                                         const bus::UsbControlRequest& request,
                                         std::uint8_t configuration) {
  switch (request.request) {
    case kGetStatus: {
      const bool is_device = (request.request_type & kRecipientBits) == 0;
      return DescriptorBytes{is_device ? kSelfPowered : std::uint8_t{0}, 0};
    }
    case kGetDescriptor: {
      DescriptorBytes bytes =
          usb_descriptor(persona, static_cast<std::uint8_t>(request.value >> 8U),
                         static_cast<std::uint8_t>(request.value & 0xFFU));
      if (bytes.empty()) return std::nullopt;
      return bytes;
    }
    case kGetConfiguration:
      return DescriptorBytes{configuration};
    case kGetInterface:
      return DescriptorBytes{0};
    default:
      return std::nullopt;
  }
}

}  // namespace

bus::UsbControlRequest control_request(const std::array<std::uint8_t, 8>& setup,
                                       std::span<const std::uint8_t> data) noexcept {
  const auto word_at = [&](std::size_t place) {
    return static_cast<std::uint16_t>(setup[place] | setup[place + 1] << 8U);
  };
  bus::UsbControlRequest request{
      .request_type = setup[0], .request = setup[1], .value = word_at(2), .index = word_at(4)};
  request.length = word_at(6);
  std::copy_n(data.begin(), std::min(data.size(), request.data.size()), request.data.begin());
  return request;
}

bool is_standard(const bus::UsbControlRequest& request) noexcept {
  return (request.request_type & bus::kUsbRequestOwnerBits) == 0;
}

std::optional<DescriptorBytes> answer_standard(const UsbPersona& persona,
                                               const bus::UsbControlRequest& request,
                                               std::uint8_t& configuration) {
  if (bus::asks_for_data(request)) return answer_in(persona, request, configuration);
  switch (request.request) {
    case kSetConfiguration:
      if (request.value > 1) return std::nullopt;
      configuration = static_cast<std::uint8_t>(request.value);
      return DescriptorBytes{};
    case kSetInterface:
      // There is no alternate setting.
      if (request.value != 0 || !has_interface(persona, request.index)) return std::nullopt;
      return DescriptorBytes{};
    case kClearFeature:
    case kSetFeature:
      return DescriptorBytes{};
    default:
      return std::nullopt;
  }
}

bool ends_halt(const bus::UsbControlRequest& request,
               const bus::UsbEndpointInfo& endpoint) noexcept {
  if (request.request == kSetConfiguration) return true;
  if (request.request == kSetInterface) return request.index == endpoint.interface_number;
  return request.request == kClearFeature && request.request_type == kToEndpoint &&
         request.value == kEndpointHalt && request.index == endpoint.address;
}

}  // namespace thimble::sim
