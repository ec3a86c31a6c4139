#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace thimble::sim {

// The host's side of USB/IP: makes its messages, and takes apart what a server says. Written from
// the protocol's page, not from our codec.
struct UsbipHost {
  using Bytes = std::vector<std::uint8_t>;
  struct Reply {
    std::uint32_t command{0};
    std::uint32_t seqnum{0};
    std::int32_t status{0};
    std::uint32_t actual{0};
    Bytes data;
  };

  static void put(Bytes& bytes, std::uint32_t value) {
    for (const unsigned shift : {24U, 16U, 8U, 0U}) {
      bytes.push_back(static_cast<std::uint8_t>(value >> shift));
    }
  }
  static std::uint32_t get(std::span<const std::uint8_t> bytes, std::size_t place) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value << 8U | bytes[place + i];
    return value;
  }

  static Bytes import(const std::string& bus_id = "1-1") {
    Bytes bytes(40);
    constexpr std::array<std::uint8_t, 4> kRequest{0x01, 0x11, 0x80, 0x03};
    std::copy(kRequest.begin(), kRequest.end(), bytes.begin());
    std::copy(bus_id.begin(), bus_id.end(), bytes.begin() + 8);
    return bytes;
  }
  static Bytes devlist() { return {0x01, 0x11, 0x80, 0x05, 0, 0, 0, 0}; }

  struct Order {
    std::uint8_t endpoint{0};  // with its direction in bit 7
    std::uint32_t length{0};
    std::uint32_t flags{0};
    std::array<std::uint8_t, 8> setup{};
    Bytes data{};
  };
  Bytes submit(const Order& order) {
    Bytes bytes;
    put(bytes, 1);
    put(bytes, ++seqnum);
    put(bytes, 0x10001);
    put(bytes, order.endpoint >> 7U);
    put(bytes, order.endpoint & 15U);
    put(bytes, order.flags);
    put(bytes, order.data.empty() ? order.length : static_cast<std::uint32_t>(order.data.size()));
    for (const std::uint32_t value : {0U, 0U, 0U}) put(bytes, value);
    bytes.insert(bytes.end(), order.setup.begin(), order.setup.end());
    bytes.insert(bytes.end(), order.data.begin(), order.data.end());
    return bytes;
  }
  Bytes read(std::uint8_t endpoint, std::uint32_t length, std::uint32_t flags = 0) {
    return submit({.endpoint = endpoint, .length = length, .flags = flags});
  }
  Bytes write(std::uint8_t endpoint, Bytes data) {
    return submit({.endpoint = endpoint, .data = std::move(data)});
  }
  Bytes control(std::array<std::uint8_t, 8> setup, Bytes data = {}) {
    const auto in = static_cast<std::uint8_t>(setup[0] & 0x80U);
    const auto length = static_cast<std::uint32_t>(setup[6] | setup[7] << 8U);
    return submit({.endpoint = in, .length = length, .setup = setup, .data = std::move(data)});
  }
  Bytes unlink(std::uint32_t what) {
    Bytes bytes;
    put(bytes, 2);
    put(bytes, ++seqnum);
    put(bytes, 0x10001);
    put(bytes, 0);
    put(bytes, 0);
    put(bytes, what);
    bytes.resize(48);
    return bytes;
  }

  // The next reply in `bytes`, taken off. `is_in`: that of a submit that has data behind it.
  static std::optional<Reply> take_reply(Bytes& bytes, bool has_data) {
    if (bytes.size() < 48) return std::nullopt;
    Reply reply{get(bytes, 0),
                get(bytes, 4),
                static_cast<std::int32_t>(get(bytes, 20)),
                get(bytes, 24),
                {}};
    const std::size_t more = has_data && reply.command == 3 ? reply.actual : 0;
    if (bytes.size() < 48 + more) return std::nullopt;
    const auto body = bytes.begin() + 48;
    reply.data.assign(body, body + static_cast<std::ptrdiff_t>(more));
    bytes.erase(bytes.begin(), body + static_cast<std::ptrdiff_t>(more));
    return reply;
  }

  std::uint32_t seqnum{0};  // of the last message
};

}  // namespace thimble::sim
