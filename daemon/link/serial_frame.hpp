#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "daemon/link/thimble_codec.hpp"

namespace thimble::link {

// Datagrams of either protocol along a serial line (thesis 3.1.1), which loses and turns bytes and
// knows no beginning. A frame is the datagram with its CRC-32 (IEEE 802.3, network order) behind
// it, stuffed so that it has no zero byte (COBS: Cheshire and Baker, SIGCOMM 1997), between two
// zeros. Whoever listens in the middle, or after noise, is in step again at the next zero.
//
// Thread: one. RT: pure, allocation-free. Errors: total, any bytes give frames or counts.

inline constexpr std::size_t kSerialChecksum = 4;
inline constexpr std::size_t kMaxFramed = kMaxThimbleDatagram + kSerialChecksum;
// A byte for each 254 and the first, and a zero at either end.
inline constexpr std::size_t kMaxSerialFrame = kMaxFramed + kMaxFramed / 254 + 1 + 2;

struct SerialFrame {
  std::array<std::byte, kMaxSerialFrame> bytes{};
  std::size_t size{0};
  [[nodiscard]] std::span<const std::byte> view() const noexcept {
    return std::span(bytes).first(size);
  }
};

// `datagram` of 1 to kMaxThimbleDatagram bytes; of any other size the frame is empty.
[[nodiscard]] SerialFrame frame(std::span<const std::byte> datagram) noexcept;

[[nodiscard]] std::uint32_t crc32(std::span<const std::byte> bytes) noexcept;

// Between two reads. Ours: longer than most machines are late by, and shorter than who hears no
// answer waits before it asks again.
inline constexpr Duration kLineSilence = std::chrono::milliseconds(100);

// Finds the datagrams in a stream of bytes, however it is cut.
class Deframer {
 public:
  struct Counters {
    std::uint64_t frames{0};
    // Wrongly stuffed, of no length, with another checksum, or too long: once for each
    // kMaxSerialFrame bytes without an end. Also each zero that can be no end, behind two others,
    // and what was not over at the second silence.
    std::uint64_t damaged{0};
  };

  // Before the bytes of each read. A frame may have one kLineSilence in it: a reader that is late
  // finds its rest then, and where the line was silent in truth the zero before the next frame ends
  // it. What has no end at another silence is none.
  void on_read(MonotonicTime now) noexcept;
  // The next byte of the line. Where it ends a whole frame, its datagram, until the next call.
  [[nodiscard]] std::optional<std::span<const std::byte>> push(std::byte byte) noexcept;
  [[nodiscard]] const Counters& counters() const noexcept { return counters_; }

 private:
  [[nodiscard]] std::optional<std::span<const std::byte>> end_of_frame() noexcept;

  std::array<std::byte, kMaxSerialFrame> stuffed_{};
  std::size_t size_{0};
  bool is_too_long_{false};
  bool is_behind_two_zeros_{false};
  bool is_behind_silence_{false};  // what has no end yet
  MonotonicTime read_at_{};
  std::array<std::byte, kMaxSerialFrame> plain_{};
  Counters counters_{};
};

// When the line is free again: what was handed to it leaves at its rate, 10 bits a byte (8 data
// bits, start and stop). A sender that waits for that never has more than one frame between itself
// and the other end, and its newest sample is new.
class LinePace {
 public:
  explicit LinePace(std::uint32_t bit_per_s) noexcept : bit_per_s_(bit_per_s) {}
  [[nodiscard]] MonotonicTime free_at() const noexcept { return free_at_; }
  void on_sent(std::size_t bytes, MonotonicTime now) noexcept;

 private:
  std::uint32_t bit_per_s_;
  MonotonicTime free_at_{};
};

}  // namespace thimble::link
