#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "hal/base/time.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::sim {

enum class FaultKind : std::uint8_t {
  DropIn,       // an input report never arrives
  DropOut,      // an output report never reaches the device
  DelayIn,      // an input report arrives late
  DelayOut,     // an output report reaches the device late
  CorruptIn,    // one byte of an input report is another one
  CorruptOut,   // one byte of an output report is another one
  TruncateIn,   // an input report is cut short
  TruncateOut,  // an output report is cut short; of HID by ShortReports, at the device's plug
  Stall,        // nothing passes; the newest output report waits
  Disconnect,   // the device is gone, for good as far as a handle used meanwhile goes
  // Of the bus rather than of a report; they look at the time only.
  RefuseOpen,   // somebody else holds the device
  LoseEvents,   // arrivals and departures of the device are never told
  DelayEvents,  // nothing on this bus is told until it ends
  // Of a bare USB device, where a report is a packet of one endpoint.
  Halt,    // the device answers STALL: the packet or request is lost, and its sender told
  Babble,  // a packet from the device is longer than asked for: lost, and its reader told
};
inline constexpr std::size_t kFaultKindCount = 15;
inline constexpr std::size_t kHidFaultKindCount = 13;  // the kinds before Halt

inline constexpr std::uint8_t kHidOut = 0x01;  // where a HID device has one at all

// One fault that happens while both windows hold.
struct ScriptedFault {
  FaultKind kind{};
  // Time of the clock: from `from`, for `lasts`.
  MonotonicTime from{Duration::min()};
  Duration lasts{Duration::max()};
  // Number of the report, 1 for the first one of its direction on this handle: from
  // `first_report`, `reports` of them. Stall and Disconnect look at the time only.
  std::uint64_t first_report{1};
  std::uint64_t reports{std::numeric_limits<std::uint64_t>::max()};
  Duration delay{};  // DelayIn, DelayOut
  // Of a bare USB device: that endpoint alone, 0 for its requests. Of a HID device: a Stall of
  // kHidOut is a write that is blocked, while input passes. Everything else takes no notice.
  std::optional<std::uint8_t> endpoint{};

  THIMBLE_RT [[nodiscard]] bool covers(MonotonicTime t) const noexcept;
  THIMBLE_RT [[nodiscard]] bool covers(std::uint64_t report) const noexcept;
};

// Chance of each fault per report, 0 to 1.
struct RandomFaults {
  double drop_in{0};
  double drop_out{0};
  double delay_in{0};
  double delay_out{0};
  double corrupt_in{0};
  double corrupt_out{0};
  double truncate_in{0};
  double truncate_out{0};
  double stall{0};  // per input report
  double halt{0};
  double babble{0};
  Duration max_delay{};  // a delay is uniform in (0, max_delay]
  Duration stall_lasts{};
  bool operator==(const RandomFaults&) const = default;
};

// Everything that is to go wrong on one handle; the same plan gives the same faults.
struct FaultPlan {
  std::uint64_t seed{0};
  std::vector<ScriptedFault> script;
  RandomFaults random;
};

// A number that depends on its arguments only, uniform in 64 bit: what happens to report n
// does not depend on what was asked before. Mixer: splitmix64 (Steele, Lea, Flood 2014).
THIMBLE_RT [[nodiscard]] std::uint64_t fault_bits(std::uint64_t seed, FaultKind kind,
                                                  std::uint64_t report) noexcept;
// True with probability `chance`.
THIMBLE_RT [[nodiscard]] bool fault_strikes(std::uint64_t bits, double chance) noexcept;

}  // namespace thimble::sim
