#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "hal/base/time.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::phantom {

// Tells from the counters alone that the controller's calibration button was pressed: it then sets
// them to zero by itself, and says nothing of it.
//
// So a press is a jump of an arm that is held still: all three counters stood for kStillFor, then
// in one report all are near zero and one at least came from far. The counter that a controller
// makes up before its first press never gets near zero, and it jumps only at the press. A press
// with the counters near zero already is not seen (is_unseen_at()): an arm that was switched on, or
// whose button was pressed, in this very pose.
// No motion of an arm that was still a report ago is a jump.
//
// Thread: one. RT: all THIMBLE_RT. A value. Errors: none, whatever the counters say.
class ZeroJump {
 public:
  using Counts = std::array<std::int32_t, 3>;

  // Takes the counters of one report, `since_last` after the one before.
  THIMBLE_RT void on_counts(const Counts& counts, Duration since_last) noexcept;
  // From the jump on until lower(), or until the counters jump again: then it was a broken line.
  [[nodiscard]] bool is_pressed() const noexcept { return is_pressed_; }
  // A press with these counters would be no jump.
  THIMBLE_RT [[nodiscard]] static bool is_unseen_at(const Counts& counts) noexcept;
  THIMBLE_RT void lower() noexcept { is_pressed_ = false; }
  // Reports are missing: what follows is no jump.
  THIMBLE_RT void forget() noexcept { *this = ZeroJump(); }

  // Ours. Hands tremble by less than a count a millisecond.
  static constexpr Duration kStillFor = std::chrono::milliseconds(20);
  static constexpr std::int32_t kStill_counts = 4;
  static constexpr std::int32_t kNearZero_counts = 8;
  // Ours: 0.5 mm at the tip of a PHANToM, which is five times what is allowed to "still".
  static constexpr std::int32_t kJump_counts = 20;

 private:
  std::optional<Counts> last_{};
  Duration still_for_{};
  bool is_pressed_{false};
};

}  // namespace thimble::phantom
