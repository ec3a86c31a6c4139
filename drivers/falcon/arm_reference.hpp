#pragma once

#include <array>
#include <cstdint>

#include "drivers/falcon/falcon_codec.hpp"
#include "drivers/falcon/falcon_model.hpp"
#include "hal/base/time.hpp"
#include "hal/device/haptic_device.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::falcon {

// Whether the encoders mean anything. The firmware finds its own origins while it is told to home
// and a person moves the grip from end to end; it says so by three bits, and keeps them as long as
// it runs. They are believed when kHomedReports in a row have them all, and the encoders, which
// jump to their origins at that moment, move in them as fast as a motor can.
//
// Known, the reference is lost when an encoder jumps and after kLongestGap without a report. What
// the firmware says then is listened to again.
//
// Thread: one. RT: all THIMBLE_RT but the constructor, which alone looks at the model. Errors:
// none; what cannot be true ends the reference.
class ArmReference {
 public:
  explicit ArmReference(const FalconModel& model);

  // Takes one report, `since_last` after the one before. False: the encoders jumped, and what was
  // known is lost.
  THIMBLE_RT bool on_report(const RunReport& report, Duration since_last) noexcept;
  THIMBLE_RT void forget() noexcept;
  [[nodiscard]] CalibrationState state() const noexcept { return state_; }
  [[nodiscard]] bool is_known() const noexcept { return state_ == CalibrationState::Ok; }

  // No check sum protects a report: bytes gone wrong do not repeat. Ours.
  static constexpr int kHomedReports = 5;
  // Ours: a firmware that started anew in that time cannot be told from one that did not.
  static constexpr Duration kLongestGap = std::chrono::milliseconds(100);

 private:
  [[nodiscard]] bool is_jump(const RunReport& report, Duration since_last) const noexcept;

  double counts_per_s_;  // no encoder is faster
  CalibrationState state_{CalibrationState::Unknown};
  std::array<std::int16_t, 3> last_counts_{};
  bool has_last_{false};
  int homed_reports_{0};
};

}  // namespace thimble::falcon
