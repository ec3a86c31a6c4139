#pragma once

#include <cstdint>
#include <string_view>

namespace thimble::safety {

// Why the chain is not healthy now; the first that fits, in this order.
enum class ChainTrouble : std::uint8_t {
  None,
  NoLines,        // the chip or one of its lines is not there
  Silent,         // the chip has not answered for kSilence
  OutputStuck,    // the chip has not taken an output for kSilence, with an enable line kEnableGap
  EdgesLost,      // something happened on a line that was not told
  Open,           // the emergency stop is pressed, or its wire is broken
  Disagree,       // one channel did not open or close with the other
  Unwatched,      // the thread that looks after the chain was held up
  ArmOutOfReach,  // an arm may hold its last force, and nothing here can end it
  EnablePaused,   // no rise of the enable line for kEnableGap, though nothing was stopped
};
inline constexpr int kChainTroubleCount = 10;

// Short name for status, e.g. "open".
[[nodiscard]] std::string_view to_string(ChainTrouble trouble) noexcept;
// What it is and what a person does about it; empty for None.
[[nodiscard]] std::string_view explain(ChainTrouble trouble) noexcept;
// What it was, once it is over; empty for None.
[[nodiscard]] std::string_view recall(ChainTrouble trouble) noexcept;

// How the chain stands. Plain, so that it crosses threads.
struct ChainStatus {
  bool is_stopped{true};                        // the latch: no arm is driven
  ChainTrouble trouble{ChainTrouble::NoLines};  // now
  ChainTrouble cause{ChainTrouble::None};       // of the newest stop; None: stopped since the start
  bool is_deadman_held{false};                  // closed, and seen open since the newest stop
  bool must_release_deadman{false};             // closed, and not seen open since then
  bool is_enable_beating{false};
  std::uint32_t stops{0};  // since the start, which is none
  std::uint32_t beats{0};  // of the enable line

  // Stopped since the start, with nothing wrong: a person is awaited, and nothing was stopped yet.
  [[nodiscard]] bool awaits_first_clear() const noexcept {
    return is_stopped && trouble == ChainTrouble::None && cause == ChainTrouble::None;
  }
};

}  // namespace thimble::safety
