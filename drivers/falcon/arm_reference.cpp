#include "drivers/falcon/arm_reference.hpp"

#include <cstdlib>
#include <numbers>

namespace thimble::falcon {

ArmReference::ArmReference(const FalconModel& model)
    : counts_per_s_(model.motor_speed_limit_rad_per_s * model.counts_per_motor_rev /
                    (2 * std::numbers::pi)) {}

bool ArmReference::on_report(const RunReport& report, Duration since_last) noexcept {
  const bool is_lost = is_jump(report, since_last) || since_last > kLongestGap;
  const bool was_known = is_known();
  last_counts_ = report.encoder_counts;
  has_last_ = true;
  if (was_known && !is_lost) return true;
  state_ = CalibrationState::NeedsUser;
  homed_reports_ = report.is_homed() && !is_lost ? homed_reports_ + 1 : 0;
  if (homed_reports_ >= kHomedReports) state_ = CalibrationState::Ok;
  return !was_known;
}

void ArmReference::forget() noexcept {
  state_ = CalibrationState::Unknown;
  has_last_ = false;
  homed_reports_ = 0;
}

// A report is sampled up to a frame before it arrives, so two may be a frame further apart.
bool ArmReference::is_jump(const RunReport& report, Duration since_last) const noexcept {
  if (!has_last_) return false;
  const double allowed_counts = counts_per_s_ * seconds(since_last + wire::kFramePeriod);
  for (std::size_t i = 0; i < 3; ++i) {
    const int moved = std::abs(int{report.encoder_counts[i]} - int{last_counts_[i]});
    if (moved > allowed_counts) return true;
  }
  return false;
}

}  // namespace thimble::falcon
