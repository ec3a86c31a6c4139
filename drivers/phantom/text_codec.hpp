#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/phantom/text_wire.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::phantom {

// One line of the controller, as it stands there.
struct TextReport {
  std::int32_t model{0};
  std::array<std::int32_t, text::kCounterCount> counts{};
  std::int32_t error{0};
  bool operator==(const TextReport&) const = default;
};

// One message to the controller, ready for the bus.
struct TextMessage {
  std::array<std::uint8_t, 32> bytes{};
  std::size_t size{0};
  [[nodiscard]] std::span<const std::uint8_t> payload() const noexcept {
    return {bytes.data(), size};
  }
};

// Nothing but eight whole numbers within 32 bits, as "%d" writes them, between brackets with a
// comma between each. Total: any bytes. Thread: any. RT: THIMBLE_RT.
THIMBLE_RT [[nodiscard]] std::optional<TextReport> parse_text_report(
    std::span<const std::uint8_t> line) noexcept;

// Currents a, b, c in ampere: rounded to mA, held within ±`full_scale_a` (above 0, at most
// 32.767 A), for beyond it the controller takes 0; not finite: 0. It begins with a byte that the
// controller may lose (text::kToLose). Thread: any. RT: THIMBLE_RT.
THIMBLE_RT [[nodiscard]] TextMessage encode_text_currents(const std::array<double, 3>& current_a,
                                                          double full_scale_a) noexcept;

// Finds the lines in a stream of bytes: from a bracket to the next closing one. Whatever the bytes,
// it holds at most kMostBytes of them, and the next line after any garbage is found.
//
// Thread: one. RT: all THIMBLE_RT.
class TextLines {
 public:
  // Longer is no report: eight numbers of eleven letters, commas and brackets make 97.
  static constexpr std::size_t kMostBytes = 97;

  // The whole line, brackets and all, when `byte` ends one; else empty. Valid until the next call.
  THIMBLE_RT std::span<const std::uint8_t> take(std::uint8_t byte) noexcept;
  // Bytes are missing here: what was begun is lost.
  THIMBLE_RT void forget() noexcept;
  // Bytes of no line, but for newlines, returns and NULs.
  [[nodiscard]] std::uint64_t lost_bytes() const noexcept { return lost_bytes_; }

 private:
  std::array<std::uint8_t, kMostBytes> line_{};
  std::size_t size_{0};  // 0: outside of brackets
  std::uint64_t lost_bytes_{0};
};

}  // namespace thimble::phantom
