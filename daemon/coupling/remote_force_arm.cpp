#include "daemon/coupling/remote_force_arm.hpp"

namespace thimble::coupling {

RemoteForceArm::RemoteForceArm(const RemoteForceSettings& settings) noexcept
    : tool_(settings.tool), port_(settings.age) {}

void RemoteForceArm::restart(MonotonicTime now, Position3 tip) noexcept {
  port_.reset(now, tip);
  force_ = {};
  is_pressing_ = false;
}

ArmOutput RemoteForceArm::advance(const ArmInput& input) noexcept {
  if (!is_finite(input.tip) || !is_finite(input.tip_velocity)) return port_.refuse(input);
  const FarEnd* const far = port_.listen(input);
  if (port_.is_new_epoch()) {
    force_ = {};
    is_pressing_ = false;
  }
  if (far != nullptr) {
    force_ = far->force;
    is_pressing_ = far->is_pressing;
  }
  return port_.show(input, force_, is_pressing_, tool_);
}

}  // namespace thimble::coupling
