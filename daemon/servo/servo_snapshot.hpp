#pragma once

#include <array>
#include <cstdint>

#include "daemon/coupling/felt_hand.hpp"
#include "daemon/servo/servo_frame.hpp"
#include "hal/device/fault.hpp"

namespace thimble::servo {

// What observers see of a servo, once per tick, through a word seqlock.
struct ServoSnapshot {
  ServoFrame frame{};
  coupling::FeltHand felt{};  // while it is not driven: the tip
  Fault fault{};
  std::array<double, 3> gimbal_rad{};  // joints 3 to 5 of HapticState, where the arm has them
  double peak_force_newton{0};         // largest norm sent since the servo was made
  double peak_offset_m{0};             // largest norm of the coordinate offset since then
  std::uint64_t total_contacts{0};
  std::uint64_t overruns{0};  // periods that passed without a tick
  std::uint64_t missed_exchanges{0};
  std::uint64_t faults{0};  // latched since the servo was made
  std::uint64_t protocol_errors{0};
  std::uint32_t clear_answered{0};  // ClearRequest::id of the newest that was judged
  ClearOutcome clear_outcome{ClearOutcome::None};
  bool was_pulled{false};      // after it was driven, and not cleared since: calibrated first
  bool is_place_known{false};  // calibrated, and its newest sample is no older than allowed
  bool may_hold_force{false};  // its motors, as far as is known: HeldForce
  bool is_kept_out{false};     // only its finger's place, outside its world, keeps it from a force
};

}  // namespace thimble::servo
