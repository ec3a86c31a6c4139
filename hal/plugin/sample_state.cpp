#include "hal/plugin/sample_state.hpp"

#include <algorithm>

namespace thimble::plugin {
namespace {

static_assert(THIMBLE_JOINTS == kMaxJoints);

CalibrationState calibration_of(const thimble_sample& sample) noexcept {
  switch (sample.calibration) {
    case THIMBLE_CALIBRATION_DONE:
      return CalibrationState::Ok;
    case THIMBLE_CALIBRATION_NEEDS_PERSON:
      return CalibrationState::NeedsUser;
    default:
      return CalibrationState::Unknown;
  }
}

}  // namespace

void copy_sample(const thimble_sample& sample, std::size_t joints, HapticState& out) noexcept {
  const bool is_known = sample.calibration == THIMBLE_CALIBRATION_DONE;
  out.joint_position_rad = {};
  std::copy_n(sample.joint_position_rad, is_known ? joints : 0, out.joint_position_rad.begin());
  out.tip = {sample.tip_m[0], sample.tip_m[1], sample.tip_m[2]};
  for (std::size_t motor = 0; motor < THIMBLE_MOTORS; ++motor) {
    std::copy_n(sample.motor_current_a_per_newton[motor], 3,
                out.motor_current_per_force.row[motor].begin());
  }
  out.buttons = sample.buttons;
  out.calibration = calibration_of(sample);
}

void doubt_calibration(thimble_sample& sample, bool& is_doubted) noexcept {
  if (sample.calibration != THIMBLE_CALIBRATION_DONE) {
    is_doubted = false;
  } else if (is_doubted) {
    sample.calibration = THIMBLE_CALIBRATION_NEEDS_PERSON;
  }
}

}  // namespace thimble::plugin
