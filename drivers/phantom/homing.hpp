#pragma once

#include <cstdint>

#include "drivers/phantom/phantom_codec.hpp"
#include "hal/base/time.hpp"
#include "hal/device/haptic_device.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::phantom {

// The way from "the counters mean nothing" to "the counters are zero in the home pose".
//
// A press of the calibration button counts only when it was seen to begin: a flag that is up
// at the start may be hours old and the arm elsewhere by now, so it is cleared first. And only
// when kPressReports in a row have the flag: the controller keeps it up until told otherwise,
// bytes gone wrong do not repeat. The press then makes the controller zero its counters
// (command 1, which also lowers the flag).
// The command is repeated until the flag is down, so a lost or superseded report does no
// harm; and because such a repetition may still be on its way then, the reference holds only
// after the flag stayed down for kSettle.
//
// Thread: one. RT: all THIMBLE_RT. A value. Errors: none, whatever a report says.
class Homing {
 public:
  // Takes one report of the controller, `since_last` after the one before.
  THIMBLE_RT void on_report(const DeviceReport& report, Duration since_last) noexcept;
  THIMBLE_RT void forget() noexcept { *this = Homing(); }

  // The next report to the controller must zero its counters.
  [[nodiscard]] bool wants_zero_counters() const noexcept {
    return step_ == Step::Clearing || step_ == Step::Zeroing;
  }
  [[nodiscard]] CalibrationState state() const noexcept;

  // No check sum protects a report. Ours: 5 ms of a press, which lasts 50 at least.
  static constexpr int kPressReports = 5;
  // Far above the two frames a report spends on the bus, far below what a person notices.
  static constexpr Duration kSettle = std::chrono::milliseconds(20);
  // An arm that is held still does not turn a motor further than this while settling: about
  // 5 degrees of a forearm. More means that it was not held, or that the firmware lowered the
  // flag without zeroing its counters. Ours.
  static constexpr std::int16_t kHeldStill_counts = 400;

 private:
  enum class Step : std::uint8_t {
    Unknown,   // no report yet
    Clearing,  // an old flag is up: lower it
    Waiting,   // for a person to press the button
    Zeroing,   // pressed: zero the counters
    Settling,  // zeroed: let repetitions of the command pass
    Done,
  };
  Step step_{Step::Unknown};
  int presses_{0};  // reports with the flag, in a row, while Waiting
  Duration settled_{};
};

}  // namespace thimble::phantom
