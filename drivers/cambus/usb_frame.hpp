#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "drivers/cambus/cambus_usb_wire.hpp"

namespace thimble::cambus {

// What a request and a reply begin with (docs/cambus.md, section 7).
struct UsbHead {
  usb::Kind kind{};
  usb::Status status{};  // of a reply
  std::uint16_t number{0};
  std::uint16_t words{0};  // to read or write; of a reply: that follow
  std::uint32_t offset{0};
  bool operator==(const UsbHead&) const = default;
};

struct UsbReply {
  UsbHead head;
  std::span<const std::uint8_t> payload;  // of the transfer it was parsed from
};

// The transfer of a request. `payload`: of a write, 4 bytes a word.
[[nodiscard]] std::vector<std::uint8_t> usb_request(const UsbHead& head,
                                                    std::span<const std::uint8_t> payload);
// Nothing where it is none, or was spoilt. Pure and total.
[[nodiscard]] std::optional<UsbReply> parse_usb_reply(std::span<const std::uint8_t> transfer);

}  // namespace thimble::cambus
