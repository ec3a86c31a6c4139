#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/falcon/falcon_wire.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::falcon {

// Translation between bytes and values of the run mode, and the serial bytes in a USB packet. Pure
// and total: any bytes give a report or nothing, any numbers give bytes.
// Thread: any. RT: all THIMBLE_RT.

// What the arm says once per exchange.
struct RunReport {
  std::array<std::int16_t, 3> encoder_counts{};  // top, right, left
  std::uint8_t buttons{0};                       // wire::kButton…
  std::uint8_t homed{0};                         // wire::kHomed: valid while homing is asked for
  [[nodiscard]] bool is_homed() const noexcept { return homed == wire::kAllHomed; }
  bool operator==(const RunReport&) const = default;
};

struct Lights {
  bool is_red{false};
  bool is_green{false};
  bool is_blue{false};
  bool operator==(const Lights&) const = default;
};

// What the arm is told once per exchange.
struct RunCommand {
  std::array<std::int16_t, 3> motor_counts{};  // held within ±wire::kMaxMotor_counts
  bool is_homing{false};
  Lights lights{};
};

using RunPacket = std::array<std::uint8_t, wire::kRunBytes>;

THIMBLE_RT [[nodiscard]] RunPacket encode_run_command(const RunCommand& command) noexcept;

// The bytes of the serial line in one IN packet of the bridge: all behind the modem's status. Empty
// for a packet of nothing else, and for one that has not even that.
THIMBLE_RT [[nodiscard]] std::span<const std::uint8_t> serial_bytes(
    std::span<const std::uint8_t> usb_packet) noexcept;

// Finds the reports in the bytes of the serial line, however they are split and glued, and what
// lies between them: a report begins with '<', has '>' 15 bytes later, and numbers and flags that
// can be. The first that fits counts; after it, and behind a '<' that did not fit, the search goes
// on with the next byte. Nothing protects a report against a nibble that became another.
//
// Thread: one. RT: all THIMBLE_RT.
class RunParser {
 public:
  // The report that ends with this byte, if one does.
  THIMBLE_RT std::optional<RunReport> take(std::uint8_t byte) noexcept;
  THIMBLE_RT void forget() noexcept { size_ = 0; }
  // Bytes that belong to no report, since construction.
  [[nodiscard]] std::uint64_t lost_bytes() const noexcept { return lost_bytes_; }

 private:
  void drop_to_next_begin() noexcept;

  RunPacket window_{};  // the bytes that may still become a report
  std::size_t size_{0};
  std::uint64_t lost_bytes_{0};
};

}  // namespace thimble::falcon
