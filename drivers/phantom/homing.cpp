#include "drivers/phantom/homing.hpp"

#include <algorithm>

namespace thimble::phantom {
namespace {

bool is_held_still(const DeviceReport& report) noexcept {
  return std::all_of(report.base_counts.begin(), report.base_counts.end(), [](std::int16_t counts) {
    return counts >= -Homing::kHeldStill_counts && counts <= Homing::kHeldStill_counts;
  });
}

}  // namespace

void Homing::on_report(const DeviceReport& report, Duration since_last) noexcept {
  const bool is_pressed = report.is_calibration_pressed;
  switch (step_) {
    case Step::Unknown:
    case Step::Clearing:
      step_ = is_pressed ? Step::Clearing : Step::Waiting;
      return;
    case Step::Waiting:
      presses_ = is_pressed ? presses_ + 1 : 0;
      if (presses_ < kPressReports) return;
      presses_ = 0;
      step_ = Step::Zeroing;
      return;
    case Step::Zeroing:
      if (is_pressed) return;
      step_ = Step::Settling;
      settled_ = {};
      return;
    case Step::Settling:
      // Pressed again, or a firmware that raises the flag for as long as the button is down.
      if (is_pressed) {
        step_ = Step::Zeroing;
        return;
      }
      settled_ += since_last;
      if (settled_ >= kSettle) step_ = is_held_still(report) ? Step::Done : Step::Waiting;
      return;
    case Step::Done:
      // A press now would move the reference while forces act: it counts after forget().
      return;
  }
}

CalibrationState Homing::state() const noexcept {
  if (step_ == Step::Unknown) return CalibrationState::Unknown;
  return step_ == Step::Done ? CalibrationState::Ok : CalibrationState::NeedsUser;
}

}  // namespace thimble::phantom
