#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "hal/base/result.hpp"

namespace thimble::sim {

// With what each takes. Bounds and defaults are ours: metres up to 1 either way, newtons up to 50,
// as no arm here is longer or stronger; seconds of a stroke of the hand from 0.001, its shortest,
// to 60, else 1; of all others from 0 to 3600, else 1; the number of a button up to 31; of reports
// up to a million, else 1.
enum class VerbKind : std::uint8_t {
  Move,   // X Y Z [SECONDS]: the hand brings the tip there, m in the arm's base frame, and holds it
  Home,   // [SECONDS]: to the pose in which the arm is calibrated, by the way that it needs
  LetGo,  // the hand leaves the tip
  Push,   // X Y Z: a constant force on the tip, N
  Press,  // N: button 0 is that of the calibration, 1 that of the stylus
  Release,    // N
  Unplug,     // with its supply
  PullCable,  // its supply stays: its firmware goes on
  Plug,
  Stall,     // SECONDS: it refuses everything
  Nak,       // SECONDS: it neither takes nor gives anything
  Corrupt,   // [N]: bits of the next N reports are turned over
  Short,     // [N]: the next N reports are cut to half
  Babble,    // [N]: the next N reports are longer than they may be
  ShortOut,  // [N]: of the next N reports that it is sent it takes half
  Halt,      // [N]: the next N transfers halt their endpoints
  Fault,     // NAME [N]: what its firmware does wrong, by its own names; N whole
  Status,
  Log,   // [SECONDS]: what happened in the last ones
  Felt,  // [SECONDS [NEWTON]]: that in short; and for how long there was no more than NEWTON
};

struct Verb {
  VerbKind kind{};
  std::array<double, 4> numbers{};  // those that are not said have their default
  std::string name{};               // of a fault; empty for all others
  bool operator==(const Verb&) const = default;
};

inline constexpr std::size_t kMaxVerbBytes = 256;  // ours; of one line

// Total. InvalidArgument for a line that is no verb, names those there are; or for numbers that are
// missing, too many or beyond what an arm could do. Thread: any. Pure.
[[nodiscard]] Result<Verb> parse_verb(std::string_view line);

}  // namespace thimble::sim
