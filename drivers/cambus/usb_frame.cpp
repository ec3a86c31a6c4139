#include "drivers/cambus/usb_frame.hpp"

#include <algorithm>
#include <array>

#include "drivers/cambus/little_endian.hpp"

namespace thimble::cambus {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::array<std::uint32_t, 256> make_crc_table() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t n = 0; n < table.size(); ++n) {
    std::uint32_t crc = n;
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 1U) != 0 ? usb::kCrcPolynomial ^ (crc >> 1) : crc >> 1;
    }
    table[n] = crc;
  }
  return table;
}
constexpr auto kCrcTable = make_crc_table();

std::uint32_t add_to_crc(std::uint32_t crc, Bytes bytes) {
  for (const std::uint8_t byte : bytes) crc = kCrcTable[(crc ^ byte) & 0xffU] ^ (crc >> 8);
  return crc;
}
std::uint32_t check_of(Bytes transfer) {
  const std::uint32_t head = add_to_crc(~0U, transfer.first(usb::kAtCheck));
  return ~add_to_crc(head, transfer.subspan(usb::kHeaderBytes));
}

std::uint16_t load16(Bytes bytes) { return static_cast<std::uint16_t>(bytes[0] | bytes[1] << 8); }
void store16(std::span<std::uint8_t> bytes, std::uint16_t value) {
  bytes[0] = static_cast<std::uint8_t>(value);
  bytes[1] = static_cast<std::uint8_t>(value >> 8);
}

}  // namespace

std::vector<std::uint8_t> usb_request(const UsbHead& head, Bytes payload) {
  std::vector<std::uint8_t> transfer(usb::kHeaderBytes + payload.size());
  const std::span<std::uint8_t> bytes(transfer);
  store16(bytes.subspan(usb::kAtMagic), usb::kRequestMagic);
  bytes[usb::kAtKind] = static_cast<std::uint8_t>(head.kind);
  store16(bytes.subspan(usb::kAtNumber), head.number);
  store16(bytes.subspan(usb::kAtWords), head.words);
  store32(bytes.subspan(usb::kAtOffset), head.offset);
  std::copy(payload.begin(), payload.end(), transfer.begin() + usb::kHeaderBytes);
  store32(bytes.subspan(usb::kAtCheck), check_of(transfer));
  return transfer;
}

std::optional<UsbReply> parse_usb_reply(Bytes transfer) {
  if (transfer.size() < usb::kHeaderBytes) return std::nullopt;
  if (load16(transfer.subspan(usb::kAtMagic)) != usb::kReplyMagic) return std::nullopt;
  if (transfer[usb::kAtKind] > static_cast<std::uint8_t>(usb::Kind::Begin)) return std::nullopt;
  if (transfer[usb::kAtStatus] > static_cast<std::uint8_t>(usb::Status::OutOfOrder)) {
    return std::nullopt;
  }
  UsbReply reply;
  reply.head.kind = static_cast<usb::Kind>(transfer[usb::kAtKind]);
  reply.head.status = static_cast<usb::Status>(transfer[usb::kAtStatus]);
  reply.head.number = load16(transfer.subspan(usb::kAtNumber));
  reply.head.words = load16(transfer.subspan(usb::kAtWords));
  reply.head.offset = load32(transfer.subspan(usb::kAtOffset));
  reply.payload = transfer.subspan(usb::kHeaderBytes);
  if (reply.payload.size() != 4 * std::size_t{reply.head.words}) return std::nullopt;
  if (load32(transfer.subspan(usb::kAtCheck)) != check_of(transfer)) return std::nullopt;
  return reply;
}

}  // namespace thimble::cambus
