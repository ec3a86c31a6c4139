#include "daemon/coupling/remote_force_world.hpp"

#include "daemon/coupling/tell.hpp"
#include "daemon/coupling/wall_penalty.hpp"

namespace thimble::coupling {

Result<void> RemoteForceWorld::open(const HandSample& first) {
  if (Result<void> opened = probe_.open(first); !opened) return opened;
  last_ = {};
  last_.session = next_session_++;
  return {};
}

ConstraintSet RemoteForceWorld::answer(const HandSample& sample, Duration dt) noexcept {
  if (!probe_.is_open() || !is_finite(sample.velocity)) return last_;
  if (sample.sequence <= last_.answers) return last_;
  if (!follow_and_tell(probe_, sample, dt, last_)) return last_;
  last_.has_far = true;
  last_.far.slave = sample.hand;
  last_.far.velocity = sample.velocity;
  last_.far.force = wall_penalty(last_.planes, sound_tool(sample.tool, kHardestTool), sample.hand,
                                 sample.velocity);
  last_.far.is_pressing = last_.far.force != Force3{};
  return last_;
}

}  // namespace thimble::coupling
