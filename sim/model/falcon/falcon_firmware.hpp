#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/rt/annotations.hpp"

namespace thimble::sim {

// Whole encoder counts of the three cranks, 0 where the crank stands at its home angle.
using CrankCounts = std::array<std::int64_t, 3>;

// What a person may ask the firmware to do wrong, in numbers of replies; 0: never.
struct FalconReplyFaults {
  std::uint64_t short_every{0};  // every so many-th reply lacks its last two bytes
  std::uint64_t glue_every{0};   // every so many-th reply waits and goes with the next one
};

struct FalconFirmwareCounters {
  std::uint64_t requests{0};       // handled, and so answered
  std::uint64_t broken{0};         // 16 bytes from a '<' on that are no request: not answered
  std::uint64_t stray_bytes{0};    // outside a request
  std::uint64_t clamped{0};        // motor commands beyond +-4095
  std::uint64_t unknown_flags{0};  // requests with a flag that nobody knows
  std::uint64_t forces_before_homed{0};
  bool operator==(const FalconFirmwareCounters&) const = default;
};

// The firmware of run mode: 16 bytes in, 16 bytes out, never unasked (arms.md 1.6, 1.9).
//
// Ours, where the sheet knows nothing: a request takes no time; one that is broken is dropped, the
// next one sought from the next '<', nothing answered; commands beyond +-4095 are clamped; there
// is no watchdog, so the last command holds for ever; a crank's origin is seen when it passes
// its home angle inwards while the last request had the homing flag; what is homed stays so until
// the processor is reset, but the bits are told only while the flag is set; byte 14 is 'A'.
//
// Thread: one. RT: all. Errors: none: any bytes are taken.
class FalconFirmware {
 public:
  // Where the cranks are now becomes 0.
  THIMBLE_RT void start(const CrankCounts& now) noexcept;
  // What is to be sent now, up to two replies; valid until the next call.
  THIMBLE_RT std::span<const std::uint8_t> take(std::uint8_t byte, const CrankCounts& now) noexcept;
  // Of its replies to `heard` more bytes.
  [[nodiscard]] std::size_t most_reply_bytes(std::size_t heard) const noexcept {
    return (request_bytes_ + heard) / kBytes * kBytes + held_bytes_;
  }
  // A crank went through its home angle, inwards.
  THIMBLE_RT void pass_home(std::size_t crank) noexcept;
  // Bits as the reply has them: right 1, forward 2, centre 4, left 8.
  THIMBLE_RT void set_buttons(std::uint8_t bits) noexcept { buttons_ = bits & 0x0fU; }
  void set_faults(const FalconReplyFaults& faults) noexcept { faults_ = faults; }
  [[nodiscard]] const FalconReplyFaults& faults() const noexcept { return faults_; }

  [[nodiscard]] const std::array<int, 3>& motor_counts() const noexcept { return motors_; }
  // Of the last request: green 1, blue 2, red 4.
  [[nodiscard]] std::uint8_t lamps() const noexcept { return lamps_; }
  [[nodiscard]] bool is_homing() const noexcept { return is_homing_; }
  [[nodiscard]] bool is_homed(std::size_t crank) const noexcept { return is_homed_[crank]; }
  [[nodiscard]] const FalconFirmwareCounters& counters() const noexcept { return counters_; }

 private:
  static constexpr std::size_t kBytes = 16;

  [[nodiscard]] bool is_request() const noexcept;
  void handle() noexcept;
  void put_reply(const CrankCounts& now) noexcept;
  std::span<const std::uint8_t> spoil_reply() noexcept;
  void seek_next_begin() noexcept;

  std::array<std::uint8_t, kBytes> request_{};
  std::size_t request_bytes_{0};
  std::array<std::uint8_t, 2 * kBytes> reply_{};
  std::size_t held_bytes_{0};  // of an earlier reply, at the front of reply_
  CrankCounts zero_{};
  std::array<int, 3> motors_{};
  std::array<bool, 3> is_homed_{};
  bool is_homing_{false};
  std::uint8_t lamps_{0};
  std::uint8_t buttons_{0};
  FalconReplyFaults faults_{};
  FalconFirmwareCounters counters_{};
};

}  // namespace thimble::sim
