#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hal/base/check.hpp"
#include "hal/base/result.hpp"
#include "hal/linux/descriptor.hpp"

namespace thimble::guard {

inline constexpr std::size_t kMaxZeroBytes = 65;  // a HID report of 64 and its number

// How an arm is let go, in words of its node. The packet says it as 0, 1 or 2, in this order.
enum class ZeroRoute : std::uint8_t {
  Write,    // one write() of the bytes: hidraw (the report's number first), a terminal
  UsbBulk,  // one synchronous bulk transfer on the claim that belongs to the shared descriptor
  Hiddev,   // linux::HiddevOutput
};

// All that a guard is told of its arm; it goes over a Unix socket in one packet, with two
// descriptors, in this order: of the arm's node, and of the page with the servo's heartbeat.
struct Handover {
  ZeroRoute route{ZeroRoute::Write};
  std::uint8_t endpoint{0};  // UsbBulk
  std::size_t size{0};       // of `bytes`, 1 to kMaxZeroBytes
  std::array<std::uint8_t, kMaxZeroBytes> bytes{};

  // A `size` beyond kMaxZeroBytes is a broken invariant, here and so in whatever uses it.
  [[nodiscard]] std::span<const std::uint8_t> zero() const noexcept {
    THIMBLE_CHECK(size <= kMaxZeroBytes);
    return {bytes.data(), size};
  }
  bool operator==(const Handover&) const = default;
};

// The packet: "TG", version 2 (in 0 the page had a count of beats, in 1 hiddev came with hidraw),
// route, endpoint, the bytes.
// Thread: any. Not RT: it allocates. Errors: none; of no bytes it makes a packet that is refused,
// of too many: as zero().
[[nodiscard]] std::vector<std::uint8_t> encode(const Handover& handover);
// Total. Thread: any. Errors: Malformed, for bytes that are no such packet.
[[nodiscard]] Result<Handover> parse_handover(std::span<const std::uint8_t> packet);

// Thread: one for each socket, a connected SOCK_SEQPACKET. Not RT.
struct Received {
  Handover handover;
  linux::Descriptor node;
  linux::Descriptor page;
};
// Never waits. The descriptors that go are duplicates: the caller's stay open, and the caller's.
// Errors: System: nobody is there, there is no room, or a descriptor is none. Too many bytes: as
// zero().
[[nodiscard]] Result<void> send_handover(int socket, const Handover& handover, int node, int page);
// Waits for the packet, `timeout_ms` at most; below 0: for ever. Errors: Timeout; Disconnected, the
// daemon is gone; Malformed, no handover, or without its two descriptors; System.
// What came with a packet that is refused is closed.
[[nodiscard]] Result<Received> receive_handover(int socket, int timeout_ms);

}  // namespace thimble::guard
