#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "drivers/cambus/cambus_usb_wire.hpp"

namespace thimble::sim::cam {

// What a host asks of a board over USB (docs/cambus.md, section 7).
struct UsbRequest {
  cambus::usb::Kind kind{};
  std::uint16_t number{0};
  std::uint16_t words{0};  // to read or write
  std::uint32_t offset{0};
  std::vector<std::uint32_t> payload;  // of a write
};

// One transfer; nothing where it is malformed. Pure and total.
[[nodiscard]] std::optional<UsbRequest> parse_usb_request(std::span<const std::uint8_t> transfer);

// To the request of that kind, number and offset.
[[nodiscard]] std::vector<std::uint8_t> make_usb_reply(const UsbRequest& to,
                                                       cambus::usb::Status status,
                                                       std::span<const std::uint32_t> payload);

// Packets of one endpoint to transfers: one ends with a packet that is shorter than it could be.
class PacketCollector {
 public:
  explicit PacketCollector(std::size_t packet_bytes) : packet_bytes_(packet_bytes) {}

  [[nodiscard]] bool is_between_transfers() const noexcept { return !is_begun_; }
  // Whether it ended one. Of a transfer that is too long only so much is kept that it shows.
  bool take(std::span<const std::uint8_t> packet);
  [[nodiscard]] std::span<const std::uint8_t> transfer() const noexcept { return bytes_; }
  void clear() noexcept;

 private:
  std::size_t packet_bytes_;
  bool is_begun_{false};
  std::vector<std::uint8_t> bytes_;
};

// Transfers to packets, first in first out.
class PacketFeeder {
 public:
  explicit PacketFeeder(std::size_t packet_bytes) : packet_bytes_(packet_bytes) {}

  void add(std::vector<std::uint8_t> transfer);
  [[nodiscard]] std::size_t transfers() const noexcept { return transfers_.size(); }
  [[nodiscard]] std::size_t bytes() const noexcept { return bytes_; }
  // Bytes of the next packet, which may be none; nothing: there is no packet. Of a room that is too
  // small the rest is lost.
  [[nodiscard]] std::optional<std::size_t> next(std::span<std::uint8_t> room);
  void clear() noexcept;

 private:
  std::size_t packet_bytes_;
  std::deque<std::vector<std::uint8_t>> transfers_;
  std::size_t sent_{0};   // of the first
  std::size_t bytes_{0};  // of all
};

}  // namespace thimble::sim::cam
