#include "sim/model/cam/usb_frames.hpp"

#include <algorithm>
#include <utility>

namespace thimble::sim::cam {
namespace {

namespace usb = cambus::usb;

// Bit by bit, as the standard has it.
std::uint32_t crc32(std::span<const std::uint8_t> bytes, std::uint32_t crc) {
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1U) * usb::kCrcPolynomial);
  }
  return crc;
}

// Of a whole transfer, but for the check itself.
std::uint32_t check_of(std::span<const std::uint8_t> transfer) {
  const std::uint32_t head = crc32(transfer.first(usb::kAtCheck), 0xffffffff);
  return ~crc32(transfer.subspan(usb::kHeaderBytes), head);
}

std::uint16_t half_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8);
}
std::uint32_t word_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  return std::uint32_t{half_at(bytes, at)} | std::uint32_t{half_at(bytes, at + 2)} << 16;
}
void put(std::vector<std::uint8_t>& bytes, std::uint32_t value, int size) {
  for (int i = 0; i < size; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

bool has_meaning(const UsbRequest& request, std::size_t payload_bytes) {
  switch (request.kind) {
    case usb::Kind::Begin:
      return request.words == 0 && request.offset == 0 && payload_bytes == 0;
    case usb::Kind::Read:
      return request.words >= 1 && request.words <= usb::kMostWords && payload_bytes == 0;
    case usb::Kind::Write:
      return request.words >= 1 && payload_bytes == 4 * std::size_t{request.words};
    case usb::Kind::None:
      break;
  }
  return false;
}

}  // namespace

std::optional<UsbRequest> parse_usb_request(std::span<const std::uint8_t> transfer) {
  if (transfer.size() < usb::kHeaderBytes || transfer.size() > usb::kMostBytes) return std::nullopt;
  if (half_at(transfer, usb::kAtMagic) != usb::kRequestMagic) return std::nullopt;
  if (transfer[usb::kAtKind] > 3 || transfer[usb::kAtStatus] != 0) return std::nullopt;
  UsbRequest request;
  request.kind = static_cast<usb::Kind>(transfer[usb::kAtKind]);
  request.number = half_at(transfer, usb::kAtNumber);
  request.words = half_at(transfer, usb::kAtWords);
  request.offset = word_at(transfer, usb::kAtOffset);
  const auto payload = transfer.subspan(usb::kHeaderBytes);
  if (!has_meaning(request, payload.size())) return std::nullopt;
  if (word_at(transfer, usb::kAtCheck) != check_of(transfer)) return std::nullopt;
  for (std::size_t at = 0; at < payload.size(); at += 4) {
    request.payload.push_back(word_at(payload, at));
  }
  return request;
}

std::vector<std::uint8_t> make_usb_reply(const UsbRequest& to, usb::Status status,
                                         std::span<const std::uint32_t> payload) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(usb::kHeaderBytes + payload.size_bytes());
  put(bytes, usb::kReplyMagic, 2);
  put(bytes, static_cast<std::uint32_t>(to.kind), 1);
  put(bytes, static_cast<std::uint32_t>(status), 1);
  put(bytes, to.number, 2);
  put(bytes, static_cast<std::uint32_t>(payload.size()), 2);
  put(bytes, to.offset, 4);
  put(bytes, 0, 4);
  for (const std::uint32_t word : payload) put(bytes, word, 4);
  const std::uint32_t check = check_of(bytes);
  for (std::size_t i = 0; i < 4; ++i) {
    bytes[usb::kAtCheck + i] = static_cast<std::uint8_t>(check >> (8 * i));
  }
  return bytes;
}

bool PacketCollector::take(std::span<const std::uint8_t> packet) {
  if (!is_begun_) bytes_.clear();
  const std::size_t room = usb::kMostBytes + 1 - std::min(bytes_.size(), usb::kMostBytes + 1);
  const auto kept = packet.first(std::min(packet.size(), room));
  bytes_.insert(bytes_.end(), kept.begin(), kept.end());
  is_begun_ = packet.size() >= packet_bytes_;
  return !is_begun_;
}

void PacketCollector::clear() noexcept {
  is_begun_ = false;
  bytes_.clear();
}

void PacketFeeder::add(std::vector<std::uint8_t> transfer) {
  bytes_ += transfer.size();
  transfers_.push_back(std::move(transfer));
}

std::optional<std::size_t> PacketFeeder::next(std::span<std::uint8_t> room) {
  if (transfers_.empty()) return std::nullopt;
  const auto rest = std::span(transfers_.front()).subspan(sent_);
  const std::size_t size = std::min(rest.size(), packet_bytes_);
  std::copy_n(rest.begin(), std::min(size, room.size()), room.begin());
  sent_ += size;
  if (size == packet_bytes_) return size;
  bytes_ -= transfers_.front().size();
  transfers_.pop_front();
  sent_ = 0;
  return size;
}

void PacketFeeder::clear() noexcept {
  transfers_.clear();
  sent_ = 0;
  bytes_ = 0;
}

}  // namespace thimble::sim::cam
