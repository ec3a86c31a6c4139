#include "sim/export/usbip_wire.hpp"

#include <algorithm>

namespace thimble::sim::usbip {
namespace {

constexpr std::uint16_t kVersion = 0x0111;
constexpr std::uint16_t kRequestDevlist = 0x8005;
constexpr std::uint16_t kReplyDevlist = 0x0005;
constexpr std::uint16_t kRequestImport = 0x8003;
constexpr std::uint16_t kReplyImport = 0x0003;
constexpr std::size_t kPathBytes = 256;

constexpr std::uint32_t kCommandSubmit = 1;
constexpr std::uint32_t kCommandUnlink = 2;
constexpr std::uint32_t kReplySubmit = 3;
constexpr std::uint32_t kReplyUnlink = 4;
constexpr std::uint32_t kEndpoints = 16;

// Where fields are in a header.
constexpr std::size_t kSeqnum = 4;
constexpr std::size_t kDeviceId = 8;
constexpr std::size_t kDirection = 12;
constexpr std::size_t kEndpoint = 16;
constexpr std::size_t kFlags = 20;  // of a submit; an unlink has the other's seqnum there
constexpr std::size_t kLength = 24;
constexpr std::size_t kPackets = 32;
constexpr std::size_t kSetup = 40;

std::uint16_t word16_at(std::span<const std::uint8_t> bytes, std::size_t place) noexcept {
  return static_cast<std::uint16_t>(bytes[place] << 8U | bytes[place + 1]);
}

std::uint32_t word32_at(std::span<const std::uint8_t> bytes, std::size_t place) noexcept {
  return std::uint32_t{word16_at(bytes, place)} << 16U | word16_at(bytes, place + 2);
}

void append(Bytes& bytes, std::uint8_t value) { bytes.push_back(value); }

void append(Bytes& bytes, std::uint16_t value) {
  append(bytes, static_cast<std::uint8_t>(value >> 8U));
  append(bytes, static_cast<std::uint8_t>(value & 0xFFU));
}

void append(Bytes& bytes, std::uint32_t value) {
  append(bytes, static_cast<std::uint16_t>(value >> 16U));
  append(bytes, static_cast<std::uint16_t>(value & 0xFFFFU));
}

// Ended by a zero and filled up with them.
void append_text(Bytes& bytes, const std::string& text, std::size_t room) {
  const std::size_t size = std::min(text.size(), room - 1);
  bytes.insert(bytes.end(), text.begin(), text.begin() + static_cast<std::ptrdiff_t>(size));
  bytes.resize(bytes.size() + room - size);
}

void append_record(Bytes& bytes, const DeviceRecord& device) {
  append_text(bytes, device.path, kPathBytes);
  append_text(bytes, device.bus_id, kBusIdBytes);
  append(bytes, device.bus_number);
  append(bytes, device.device_number);
  append(bytes, device.speed);
  append(bytes, device.vendor_id);
  append(bytes, device.product_id);
  append(bytes, device.version);
  // Its class, subclass and protocol; configuration 1 of one, and how many interfaces that has.
  const auto interfaces = static_cast<std::uint8_t>(device.interfaces.size());
  for (const std::uint8_t value :
       std::array<std::uint8_t, 6>{device.class_code, 0, 0, 1, 1, interfaces}) {
    append(bytes, value);
  }
}

Bytes op_header(std::uint16_t code, std::uint32_t status) {
  Bytes bytes;
  append(bytes, kVersion);
  append(bytes, code);
  append(bytes, status);
  return bytes;
}

// The basic header: devid, direction and endpoint are 0 in what a server says.
Bytes reply(std::uint32_t command, std::uint32_t seqnum, std::int32_t status) {
  Bytes bytes;
  append(bytes, command);
  append(bytes, seqnum);
  bytes.resize(kFlags);
  append(bytes, static_cast<std::uint32_t>(status));
  return bytes;
}

}  // namespace

std::optional<std::size_t> op_request_bytes(std::span<const std::uint8_t> header) noexcept {
  if (header.size() < kOpHeaderBytes || word16_at(header, 0) != kVersion) return std::nullopt;
  const std::uint16_t code = word16_at(header, 2);
  if (code == kRequestDevlist) return kOpHeaderBytes;
  if (code == kRequestImport) return kOpHeaderBytes + kBusIdBytes;
  return std::nullopt;
}

std::optional<OpRequest> parse_op_request(std::span<const std::uint8_t> bytes) {
  const std::optional<std::size_t> size = op_request_bytes(bytes);
  if (!size || *size != bytes.size()) return std::nullopt;
  if (bytes.size() == kOpHeaderBytes) return DevlistRequest{};
  const auto text = bytes.subspan(kOpHeaderBytes);
  return ImportRequest{std::string(text.begin(), std::find(text.begin(), text.end(), 0))};
}

Bytes devlist_reply(const DeviceRecord* device) {
  Bytes bytes = op_header(kReplyDevlist, 0);
  append(bytes, std::uint32_t{device == nullptr ? 0U : 1U});
  if (device == nullptr) return bytes;
  append_record(bytes, *device);
  for (const auto& interface : device->interfaces) {
    bytes.insert(bytes.end(), interface.begin(), interface.end());
    append(bytes, std::uint8_t{0});  // padding
  }
  return bytes;
}

Bytes import_reply(const DeviceRecord* device) {
  Bytes bytes = op_header(kReplyImport, device == nullptr ? 1 : 0);
  if (device != nullptr) append_record(bytes, *device);
  return bytes;
}

std::optional<Header> parse_header(std::span<const std::uint8_t, kHeaderBytes> bytes) noexcept {
  const std::uint32_t command = word32_at(bytes, 0);
  if (command == kCommandUnlink) {
    return Unlink{word32_at(bytes, kSeqnum), word32_at(bytes, kFlags)};
  }
  const std::uint32_t endpoint = word32_at(bytes, kEndpoint);
  const std::uint32_t direction = word32_at(bytes, kDirection);
  if (command != kCommandSubmit || endpoint >= kEndpoints || direction > 1) return std::nullopt;
  Submit submit;
  submit.seqnum = word32_at(bytes, kSeqnum);
  submit.device_id = word32_at(bytes, kDeviceId);
  submit.is_in = direction == 1;
  submit.endpoint = static_cast<std::uint8_t>(endpoint);
  submit.flags = word32_at(bytes, kFlags);
  submit.length = word32_at(bytes, kLength);
  submit.packets = word32_at(bytes, kPackets);
  std::copy_n(bytes.begin() + kSetup, submit.setup.size(), submit.setup.begin());
  return submit;
}

Bytes submit_reply(const Submit& submit, std::int32_t status, std::uint32_t actual,
                   std::span<const std::uint8_t> sent) {
  Bytes bytes = reply(kReplySubmit, submit.seqnum, status);
  append(bytes, actual);
  append(bytes, std::uint32_t{0});  // start frame
  append(bytes, submit.packets);
  bytes.resize(kHeaderBytes);
  bytes.insert(bytes.end(), sent.begin(), sent.end());
  return bytes;
}

Bytes unlink_reply(std::uint32_t seqnum, std::int32_t status) {
  Bytes bytes = reply(kReplyUnlink, seqnum, status);
  bytes.resize(kHeaderBytes);
  return bytes;
}

}  // namespace thimble::sim::usbip
