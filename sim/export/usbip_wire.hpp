#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

// Messages of USB/IP 1.1.1, big-endian: the kernel's Documentation/usb/usbip_protocol.rst.
//
// Thread: any; all functions are pure. Not RT. Errors: none; who parses is total.
namespace thimble::sim::usbip {

// ---- before a device is attached: one request, one reply ----------------------------------

inline constexpr std::size_t kOpHeaderBytes = 8;
inline constexpr std::size_t kBusIdBytes = 32;

struct DevlistRequest {};
struct ImportRequest {
  std::string bus_id;  // up to its first zero
};
using OpRequest = std::variant<DevlistRequest, ImportRequest>;

// Bytes of the whole request that begins with these, kOpHeaderBytes at least; nothing when there is
// no such one.
[[nodiscard]] std::optional<std::size_t> op_request_bytes(
    std::span<const std::uint8_t> header) noexcept;
// Of exactly so many bytes.
[[nodiscard]] std::optional<OpRequest> parse_op_request(std::span<const std::uint8_t> bytes);

// The device as both replies describe it. Speed: enum usb_device_speed of linux/usb/ch9.h.
inline constexpr std::uint32_t kFullSpeed = 2;
struct DeviceRecord {
  std::string path;
  std::string bus_id;
  std::uint32_t bus_number{1};
  std::uint32_t device_number{1};
  std::uint32_t speed{kFullSpeed};
  std::uint16_t vendor_id{0};
  std::uint16_t product_id{0};
  std::uint16_t version{0};    // bcdDevice of USB 2.0, table 9-8, in BCD: 0x0100 is 1.00
  std::uint8_t class_code{0};  // its subclass and protocol are 0
  // Class, subclass and protocol of each, in its one configuration; 255 at most.
  std::vector<std::array<std::uint8_t, 3>> interfaces{};
};
using Bytes = std::vector<std::uint8_t>;
// nullptr: there is none.
[[nodiscard]] Bytes devlist_reply(const DeviceRecord* device);
[[nodiscard]] Bytes import_reply(const DeviceRecord* device);

// ---- of an attached device ---------------------------------------------------------------

inline constexpr std::size_t kHeaderBytes = 48;

struct Submit {
  std::uint32_t seqnum{0};
  std::uint32_t device_id{0};
  bool is_in{false};
  std::uint8_t endpoint{0};  // its number, 0 to 15
  std::uint32_t flags{0};    // of the URB
  std::uint32_t length{0};   // of the transfer buffer, which follows when it goes out
  std::uint32_t packets{0};  // isochronous ones; 0 or 0xffffffff where there are none
  std::array<std::uint8_t, 8> setup{};
  [[nodiscard]] bool is_isochronous() const noexcept { return packets != 0 && packets != ~0U; }
};
struct Unlink {
  std::uint32_t seqnum{0};
  std::uint32_t unlinked{0};  // seqnum of the Submit
};
using Header = std::variant<Submit, Unlink>;

// Nothing for bytes that are no header of those two, or name an endpoint or a direction that cannot
// be.
[[nodiscard]] std::optional<Header> parse_header(
    std::span<const std::uint8_t, kHeaderBytes> bytes) noexcept;

// Status: 0 or a negative errno. `sent` is what came from the device, `actual` bytes and no more
// than `submit.length`; for output it is empty, and `actual` counts what the device took. Nothing
// of this is checked: a longer one goes as it is, and its end would be the peer's next header.
[[nodiscard]] Bytes submit_reply(const Submit& submit, std::int32_t status, std::uint32_t actual,
                                 std::span<const std::uint8_t> sent);
[[nodiscard]] Bytes unlink_reply(std::uint32_t seqnum, std::int32_t status);

}  // namespace thimble::sim::usbip
